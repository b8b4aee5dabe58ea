#pragma once
// What is known of every frame of a run, as frames.txt holds it: rows "stamp status features tracked ms".

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// One frame.
struct FrameRow {
  int64_t stamp_ns = 0;
  std::string status;  ///< tracked, dense or lost
  int features = 0;    ///< keypoints found
  int tracked = 0;     ///< of them, those that show landmarks of the map
  double ms = 0;       ///< wall time spent on it
};

using FrameTable = std::vector<FrameRow>;

/// Writes the file, atomically.
void write_frame_table(const std::filesystem::path& path, const FrameTable& table);

/// Throws InputError naming file and line for a row that is not one.
FrameTable read_frame_table(const std::filesystem::path& path);

}  // namespace kinloop
