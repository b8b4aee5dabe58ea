#pragma once
// In: points of the world as one moving, rolling camera measured them, and a guess of its pose and velocity.
// Out: the pose and the velocity. A rolling shutter is a measurement of velocity: rows exposed later have
// seen the camera elsewhere.

#include <optional>
#include <span>

#include "kinloop/optimize/bundle/bundle.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"

namespace kinloop {

/// A camera on the move: its pose at the time of the middle row.
struct RollingShutterPose {
  SE3 T_world_camera;
  Velocity velocity = Velocity::Zero();
};

/// How far a guessed velocity may be off, 1 sigma.
struct VelocitySigma {
  double m_s = 0.1;
  double rad_s = 0.1;
};

/// A point and how the camera measured it; the indices of the observation are not used.
struct RollingShutterObservation {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  BundleObservation seen;
};

/// Pose and velocity near `guess` under which the observations agree best (robust Gauss-Newton with the model
/// of bundle adjustment); the velocity is drawn towards that of the guess. Nothing where fewer than
/// `min_inliers` agree.
std::optional<RollingShutterPose> solve_rolling_shutter_pose(
    const PinholeCamera& camera, const SensorVector& sensor,
    std::span<const RollingShutterObservation> observations, const RollingShutterPose& guess,
    const VelocitySigma& sigma, const AbsolutePoseOptions& options);

}  // namespace kinloop
