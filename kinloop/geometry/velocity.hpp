#pragma once
// How a camera moves at a moment, and where it is shortly before and after.

#include <cstdint>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Velocity of a camera at one moment, in its own axes at that moment. As a vector it is (linear; angular),
/// the order of SE3's tangent vectors.
struct Velocity {
  Eigen::Vector3d linear_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rad_s = Eigen::Vector3d::Zero();  ///< about its direction, by its length a second

  static Velocity from_vector(const Vector6d& v) { return {v.head<3>(), v.tail<3>()}; }
  [[nodiscard]] Vector6d vector() const;
};

/// Shortest time over which a velocity is determined: below it, the noise of two poses is most of it.
constexpr int64_t kMinVelocityInterval_ns = 3'000'000;

/// Velocity of a camera that moves by SE3::exp(twist) in `dt_s` at constant twist: the same at every moment
/// of that motion.
Velocity velocity_of_twist(const Vector6d& twist, double dt_s);

/// Velocity at `T_world_before` of a camera that reaches `T_world_after` in `dt_s`, with its linear velocity
/// constant in the world and its turn rate constant in its own axes: the inverse of propagate_pose. Throws
/// std::logic_error for a `dt_s` of 0.
Velocity velocity_between(const SE3& T_world_before, const SE3& T_world_after, double dt_s);

/// The pose `dt_s` after T_world_camera for a camera that keeps its linear velocity in the world and its turn
/// rate.
SE3 propagate_pose(const SE3& T_world_camera, const Velocity& velocity, double dt_s);

/// A point of the camera frame as that camera sees it `dt_s` later: propagate_pose(T, v, dt)^-1 * T * p.
Eigen::Vector3d point_in_later_camera(const Eigen::Vector3d& p_camera, const Velocity& velocity, double dt_s);

/// The inverse of point_in_later_camera: where a point seen `dt_s` later was before.
Eigen::Vector3d point_in_earlier_camera(const Eigen::Vector3d& p_camera_later, const Velocity& velocity,
                                        double dt_s);

// Poses between two of which no measurement is left, for a camera whose acceleration is white noise.
//
// Given pose and velocity at both ends, the mean of that prior is a cubic Hermite spline, and its variance is
// that of an integrated random walk held at both ends (Barfoot 2017, "State Estimation for Robotics", section
// 3.4; Sarkka and Solin 2019).

/// A camera at one moment.
struct MovingCamera {
  int64_t stamp_ns = 0;
  SE3 T_world_camera;
  Velocity velocity;
};

/// How much a camera accelerates: power spectral density, per axis.
struct AccelerationNoise {
  double linear_m2_s3 = 0;
  double angular_rad2_s3 = 0;
};

/// A pose with the covariance of x = (translation [m]; rotation [rad]), the true pose being
/// T_world_camera * exp(x).
struct BridgedPose {
  SE3 T_world_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

/// Returns the pose at `stamp_ns`, from `before.stamp_ns` to `after.stamp_ns`, which must not be the same.
/// `velocity_noise` is the standard deviation of each axis of both velocities, m/s and rad/s.
BridgedPose bridge_motion(const MovingCamera& before, const MovingCamera& after, int64_t stamp_ns,
                          const AccelerationNoise& acceleration, const Velocity& velocity_noise);

}  // namespace kinloop
