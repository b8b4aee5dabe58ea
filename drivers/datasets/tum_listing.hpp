#pragma once
// In: the text files of a sequence in TUM layout. Out: the image files of each frame; no image is read.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// The two images of a frame.
struct FrameFiles {
  int64_t stamp_ns = 0;  ///< of the colour image
  std::filesystem::path color;
  std::filesystem::path depth;
};

struct TumListing {
  std::vector<FrameFiles> frames;     ///< in order of time
  std::vector<SkippedFrame> skipped;  ///< rows whose time stamp repeats or precedes an earlier one
};

/// Reads associations.txt ("stamp colour stamp depth" per line), or rgb.txt and depth.txt ("stamp file" per
/// line), which are associated by time stamp. Rows whose stamp does not increase are skipped; if these are
/// most of the rows, an InputError is thrown. Throws InputError naming file, line and remedy for a missing
/// folder or file, an unreadable row, and a sequence without frames. Warns of pairs in associations.txt that
/// exceed the association tolerance.
TumListing read_tum_listing(const std::filesystem::path& folder);

}  // namespace kinloop
