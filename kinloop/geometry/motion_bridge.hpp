#pragma once
// Poses between two of which no measurement is left, for a camera whose acceleration is white noise.
//
// Given pose and velocity at both ends, the mean of that prior is a cubic Hermite spline, and its variance is
// that of an integrated random walk held at both ends (Barfoot 2017, "State Estimation for Robotics", section
// 3.4; Sarkka and Solin 2019).

#include <cstdint>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/geometry/velocity.hpp"

namespace kinloop {

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
