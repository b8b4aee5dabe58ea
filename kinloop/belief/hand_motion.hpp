#pragma once
// How a hand moves a camera: its acceleration is white noise, so that its velocity is a random walk.

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Returns by how much the variance of a velocity (linear [m/s]; angular [rad/s]) grows per second.
Vector6d hand_acceleration_noise();

/// Returns the covariance of x of a pose that a constant velocity predicts over `interval_s`, where the true
/// pose is T * exp(x). The velocity was measured as the mean over `baseline_s`.
Matrix6d hand_motion_covariance(double interval_s, double baseline_s);

}  // namespace kinloop
