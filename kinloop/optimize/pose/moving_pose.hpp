#pragma once
// Estimates the pose of a moving camera from its measurements of given points and from its motion before. The
// world is the reference frame of the observations.

#include <optional>
#include <span>

#include "kinloop/optimize/pose/absolute_pose.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

// Estimates the pose and velocity of a moving rolling-shutter camera from its measurements of given points.
// The rolling shutter makes velocity observable: each row is exposed at a different camera pose.

/// Pose at the time of the middle row, and velocity.
struct RollingShutterPose {
  SE3 T_world_camera;
  Velocity velocity;
};

/// The pose and velocity of a frame, with the covariance of the pose.
struct RollingShutterSolution : RollingShutterPose {
  /// Of x = (translation [m]; rotation [rad]), where the true pose is T_world_camera * exp(x), given the
  /// points: with the velocity unknown within its prior, and the noise as the residuals show it.
  Matrix6d covariance = Matrix6d::Zero();
};

/// Standard deviation of the velocity prior.
struct VelocitySigma {
  double m_s = 0.1;
  double rad_s = 0.1;
};

/// Returns the pose and velocity near `guess` that minimize the robust cost (Gauss-Newton with the model of
/// bundle adjustment). The world is the reference frame of the observations. The velocity of the guess is a
/// prior. nullopt if there are fewer than `min_inliers` inliers.
std::optional<RollingShutterSolution> solve_rolling_shutter_pose(
    const Sensor& sensor, std::span<const PoseObservation> observations, const RollingShutterPose& guess,
    const VelocitySigma& sigma, const AbsolutePoseOptions& options);

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
