#pragma once
// Time-stamped camera poses and the TUM text format that carries them. It lives in this module, not in
// `output`, because sensor (simulation paths), eval and output all read it.

#include <filesystem>
#include <optional>
#include <vector>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

struct StampedPose {
  int64_t stamp_ns = 0;
  SE3 T_world_camera;
};

/// Poses in the order of time.
using Trajectory = std::vector<StampedPose>;

/// Reads lines "timestamp tx ty tz qx qy qz qw" (seconds, metres) and sorts them by time. Throws InputError
/// naming file and line for a line that is not eight finite numbers or whose quaternion is zero.
Trajectory read_tum_trajectory(const std::filesystem::path& path);

/// Writes the TUM format, atomically.
void write_tum_trajectory(const std::filesystem::path& path, const Trajectory& trajectory);

/// The pose at `stamp_ns`, between its two neighbours in time; nothing outside the trajectory or inside a gap
/// longer than `max_gap_ns`.
std::optional<SE3> pose_at(const Trajectory& trajectory, int64_t stamp_ns, int64_t max_gap_ns);

}  // namespace kinloop
