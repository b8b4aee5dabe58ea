#pragma once
// In: points of the world as one moving, rolling camera measured them, and a guess of its pose and velocity.
// Out: the pose and the velocity. A rolling shutter is a measurement of velocity: rows exposed later have
// seen the camera elsewhere.

#include <optional>
#include <span>

#include "kinloop/optimize/bundle/sensor_model.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"

namespace kinloop {

/// A camera on the move: its pose at the time of the middle row.
struct RollingShutterPose {
  SE3 T_world_camera;
  Velocity velocity;
};

/// How far a guessed velocity may be off, 1 sigma.
struct VelocitySigma {
  double m_s = 0.1;
  double rad_s = 0.1;
};

/// Pose and velocity near `guess` in the world, which is the reference frame of the observations, under which
/// the observations agree best (robust Gauss-Newton with the model of bundle adjustment); the velocity is
/// drawn towards that of the guess. Nothing where fewer than `min_inliers` agree.
std::optional<RollingShutterPose> solve_rolling_shutter_pose(
    const PinholeCamera& camera, const SensorVector& sensor, std::span<const PoseObservation> observations,
    const RollingShutterPose& guess, const VelocitySigma& sigma, const AbsolutePoseOptions& options);

}  // namespace kinloop
