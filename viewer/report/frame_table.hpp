#pragma once
// The frame table of a run, frames.txt: a row per frame, see docs/results.md.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// One row per frame.
struct FrameRow {
  int64_t stamp_ns = 0;
  std::string status;       ///< tracked, dense, predicted, doubtful or lost
  int features = 0;         ///< keypoints detected
  int tracked = 0;          ///< of these, keypoints matched to landmarks
  double ms = 0;            ///< wall time
  double sigma_m = 0;       ///< of the position, see position_sigma_m; 0 if unknown
  std::string cause = "-";  ///< of doubt, see name_of(DoubtCause)
  int expected = 0;         ///< landmarks of the local map in view
  double contradicted = 0;  ///< share of the surfaces that contradict the pose
  double moved = 0;         ///< share of the image that has moved
};

using FrameTable = std::vector<FrameRow>;

/// Writes the file atomically.
void write_frame_table(const std::filesystem::path& path, const FrameTable& table);

/// Also reads files of version 0.2, which end with `sigma_m`, and of older ones, without it. Throws
/// InputError naming file and line for an invalid row.
FrameTable read_frame_table(const std::filesystem::path& path);

}  // namespace kinloop
