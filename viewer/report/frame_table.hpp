#pragma once
// The frame table of a run, frames.txt: rows "stamp status features tracked ms sigma_m".

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// One row per frame.
struct FrameRow {
  int64_t stamp_ns = 0;
  std::string status;  ///< tracked, dense, doubtful or lost
  int features = 0;    ///< keypoints detected
  int tracked = 0;     ///< of these, keypoints matched to landmarks
  double ms = 0;       ///< wall time
  double sigma_m = 0;  ///< of the position, see position_sigma_m; 0 if unknown
};

using FrameTable = std::vector<FrameRow>;

/// Writes the file atomically.
void write_frame_table(const std::filesystem::path& path, const FrameTable& table);

/// Also reads files of versions until 0.2, without `sigma_m`. Throws InputError naming file and line for an
/// invalid row.
FrameTable read_frame_table(const std::filesystem::path& path);

}  // namespace kinloop
