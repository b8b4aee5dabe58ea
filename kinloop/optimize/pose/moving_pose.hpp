#pragma once
// Estimates the pose of a moving camera from its measurements of given points and from its motion before. The
// world is the reference frame of the observations.

#include <optional>
#include <span>

#include "kinloop/optimize/pose/rolling_shutter_pose.hpp"

namespace kinloop {

/// What the motion before says of a pose and of the velocity there: they are jointly normal.
struct MotionPrior {
  RollingShutterPose mean;
  Matrix6d information;    ///< of x, where the pose is that of the mean * exp(x); relative to assumed noise
  Matrix6d velocity_gain;  ///< by which the expected velocity changes with x, 1/s

  /// Returns x of a pose.
  [[nodiscard]] Vector6d deviation(const SE3& T_world_camera) const;

  /// Returns the expected velocity at a pose.
  [[nodiscard]] Velocity velocity_at(const SE3& T_world_camera) const;
};

/// Returns the pose near `guess` that minimizes the robust cost of the measurements, as they were taken in
/// motion, and of the prior, with the velocity expected there. The velocity is not estimated from the rows of
/// a rolling shutter, on which errors of the points have more influence than on the pose. nullopt if there
/// are fewer than `min_inliers` inliers.
std::optional<RollingShutterPose> solve_moving_pose(const Sensor& sensor,
                                                    std::span<const PoseObservation> observations,
                                                    const SE3& guess, const MotionPrior& prior,
                                                    const AbsolutePoseOptions& options);

}  // namespace kinloop
