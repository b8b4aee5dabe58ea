#pragma once
// In: the text files of a sequence in TUM layout. Out: the image files of each frame; no image is read.

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

struct TumListing {
  std::vector<RecordedFrame> frames;  ///< in order of time
  SkippedFrames skipped;              ///< rows whose time stamp repeats or precedes an earlier one
  Pairing pairing;
};

/// Reads associations.txt ("stamp colour stamp depth" per line), or rgb.txt and depth.txt ("stamp file" per
/// line), which are associated by time stamp. Rows whose stamp does not increase are skipped; if these are
/// most of the rows, an InputError is thrown. Throws InputError naming file, line and remedy for a missing
/// folder or file, an unreadable row, and a sequence without frames. Warns of pairs in associations.txt that
/// exceed the association tolerance.
TumListing read_tum_listing(const std::filesystem::path& folder);

/// Associates two lists of these names by time stamp, as above.
TumListing associate_lists(const std::filesystem::path& folder, const std::string& color_list,
                           const std::string& depth_list);

}  // namespace kinloop
