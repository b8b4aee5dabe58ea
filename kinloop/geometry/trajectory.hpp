#pragma once
// Time-stamped camera poses and the TUM text format. Part of this module because the simulator, evaluation
// and output all use it.

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

struct StampedPose {
  int64_t stamp_ns = 0;
  SE3 T_world_camera;
};

/// Poses sorted by time.
using Trajectory = std::vector<StampedPose>;

/// Stamps of the poses, ns.
std::vector<int64_t> stamps_of(const Trajectory& trajectory);

/// Reads lines "timestamp tx ty tz qx qy qz qw" (seconds, metres) and sorts them by time. Throws InputError
/// naming file and line if a line is not eight finite numbers or its quaternion is zero.
Trajectory read_tum_trajectory(const std::filesystem::path& path);

/// Writes the TUM format, atomically; after a line with `comment` unless that is empty.
void write_tum_trajectory(const std::filesystem::path& path, const Trajectory& trajectory,
                          std::string_view comment = {});

/// Returns the pose at `stamp_ns`, interpolated between its neighbours; nullopt outside the trajectory or
/// inside a gap longer than `max_gap_ns`.
std::optional<SE3> pose_at(const Trajectory& trajectory, int64_t stamp_ns, int64_t max_gap_ns);

}  // namespace kinloop
