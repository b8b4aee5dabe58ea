#pragma once
// In: time-stamped poses. Out: the pose at any time, smooth enough to be a hand's.

#include <cstdint>
#include <optional>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop::sim {

/// A continuous path through given poses.
class CameraPath {
 public:
  /// At least one pose, strictly increasing stamps (repeated ones are dropped).
  explicit CameraPath(Trajectory poses);

  /// The pose at a time: continuous with its velocity, and through every given pose. Before the first and
  /// after the last pose the motion goes on at constant twist.
  [[nodiscard]] SE3 at(int64_t stamp_ns) const;

  [[nodiscard]] const Trajectory& poses() const { return poses_; }

 private:
  [[nodiscard]] SE3 extrapolated(size_t index, int64_t stamp_ns) const;

  Trajectory poses_;
  std::vector<Vector6d> twist_per_s_;  ///< body velocity at every pose
};

/// The built-in path: once around a room of about 6 x 5 m in the hand of a walking person, looking at the
/// walls, and a little past its own start. World: z up, floor at z = 0, origin in the middle of the loop.
Trajectory handheld_path(uint64_t seed);

/// The "up" direction of a recorded path's world. The right axes of hand-held cameras are level on average:
/// up is the direction least present in them, or the world axis within some degrees of it, as motion-capture
/// worlds are levelled. Where the camera never turned enough to tell, or was rolled, it is z if the cameras
/// then look neither up nor straight down, else the world axis nearest to the mean of their -y axes.
Eigen::Vector3d estimate_up_direction(const Trajectory& poses);

/// Frame times: the path's own stamps (`fps` = 0), or evenly spaced from its first to its last.
/// Throws InputError for more than a day of evenly spaced ones.
std::vector<int64_t> frame_stamps(const Trajectory& poses, double fps);

}  // namespace kinloop::sim
