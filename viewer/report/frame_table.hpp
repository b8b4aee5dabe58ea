#pragma once
// The frame table of a run, frames.txt: rows "stamp status features tracked ms".

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// One row per frame.
struct FrameRow {
  int64_t stamp_ns = 0;
  std::string status;  ///< tracked, dense or lost
  int features = 0;    ///< keypoints detected
  int tracked = 0;     ///< of these, keypoints matched to landmarks
  double ms = 0;       ///< wall time
};

using FrameTable = std::vector<FrameRow>;

/// Writes the file atomically.
void write_frame_table(const std::filesystem::path& path, const FrameTable& table);

/// Throws InputError naming file and line for an invalid row.
FrameTable read_frame_table(const std::filesystem::path& path);

}  // namespace kinloop
