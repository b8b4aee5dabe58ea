#pragma once
// In: time-stamped poses. Out: the pose at any time, as smooth as hand-held motion.

#include <cstdint>
#include <optional>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop::sim {

/// A continuous path through given poses.
class CameraPath {
 public:
  /// Requires at least one pose and strictly increasing stamps (repeated ones are dropped).
  explicit CameraPath(Trajectory poses);

  /// Returns the pose at a time. The path passes through every given pose and is continuous with its
  /// velocity; beyond both ends the motion continues at constant twist.
  [[nodiscard]] SE3 at(int64_t stamp_ns) const;

  [[nodiscard]] const Trajectory& poses() const { return poses_; }

 private:
  [[nodiscard]] SE3 extrapolated(size_t index, int64_t stamp_ns) const;

  Trajectory poses_;
  std::vector<Vector6d> twist_per_s_;  ///< body velocity at every pose
};

/// Returns the built-in path: a person walks once around a room of about 6 x 5 m with a hand-held camera,
/// looking at the walls, and slightly past the start. World: z up, floor at z = 0, origin in the middle of
/// the loop. With `seconds` > 0, as much of it, at the same pace, as often around as that takes.
Trajectory handheld_path(uint64_t seed, double seconds = 0);

/// Returns the built-in path of a corridor: a person walks 14 m along it and back, looking ahead and at both
/// walls in turn. World as above. With `seconds` > 0, as much of it, at the same pace.
Trajectory corridor_path(uint64_t seed, double seconds = 0);

/// Estimates the up direction of a recorded path's world. The right axes of hand-held cameras are horizontal
/// on average: up is the direction least present in them, or the world axis within some degrees of it, since
/// motion-capture worlds are levelled. If the camera rotated too little or was rolled, up is z, provided the
/// cameras then look neither up nor straight down, else the world axis nearest to the mean of their -y axes.
Eigen::Vector3d estimate_up_direction(const Trajectory& poses);

/// Returns frame times: the path's own stamps (`fps` = 0), or evenly spaced from its first to its last.
/// Throws InputError if the latter exceed a day.
std::vector<int64_t> frame_stamps(const Trajectory& poses, double fps);

}  // namespace kinloop::sim
