#pragma once
// In: the text files of a sequence in TUM layout. Out: which images make up its frames, nothing read yet.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// One frame of a sequence: its two images.
struct FrameFiles {
  int64_t stamp_ns = 0;  ///< of the colour image
  std::filesystem::path color;
  std::filesystem::path depth;
};

struct TumListing {
  std::vector<FrameFiles> frames;     ///< in order of time
  std::vector<SkippedFrame> skipped;  ///< rows whose time stamp repeats an earlier one or goes back
};

/// Reads associations.txt ("stamp colour stamp depth" a line), or rgb.txt and depth.txt ("stamp file" a line)
/// and pairs them by time stamp. Time stamps must increase from row to row; a row whose stamp does not is
/// skipped, and an InputError where that is most of the rows. Throws InputError naming file, line and remedy
/// for a folder or file that is missing, a row that cannot be read, and a sequence without a frame. Warns of
/// pairs in associations.txt that are farther apart in time than lists would be paired.
TumListing read_tum_listing(const std::filesystem::path& folder);

}  // namespace kinloop
