#pragma once
// Standard deviation of measured depth.

#include <cmath>

namespace kinloop {

/// Standard deviation of the inverse depth of a Kinect 1 on a plane, 1/m (Khoshelham and Elberink 2012).
inline constexpr double kSensorInverseDepthSigmaPerM = 1.425e-3;

/// The same at keypoints: about four times that of the sensor, because keypoints lie on edges.
inline constexpr double kKeypointInverseDepthSigmaPerM = 6e-3;

/// The same where pairs of 3D points decide on a motion by their depth alone: a wider one lets false pairs
/// pass.
inline constexpr double kPointPairInverseDepthSigmaPerM = 2 * kSensorInverseDepthSigmaPerM;

/// Scale of Huber's loss on keypoints, standard deviations. Nearly least absolute deviations: wrong depths at
/// the edges of objects are many and one-sided.
inline constexpr double kKeypointRobustWidth = 0.5;

/// 95 % of chi2 with one, two and three degrees of freedom.
inline constexpr double kChi2At95With1Dof = 3.841, kChi2At95With2Dof = 5.991, kChi2At95With3Dof = 7.815;

/// Axial noise of depth on a plane: sigma_z = coefficient (z^2 + crossover^2).
///
/// A sensor that triangulates (structured light, stereo) has constant disparity noise: `crossover_m` is 0 and
/// the noise is constant in inverse depth. That of a time-of-flight sensor is nearly constant in depth as far
/// as `crossover_m`, where it has doubled, and grows with the square of the distance beyond, as less light
/// returns.
struct DepthNoise {
  double coefficient_per_m = kSensorInverseDepthSigmaPerM;  ///< of inverse depth, far away
  double crossover_m = 0;

  /// Returns the noise with sigma_z = constant_m + coefficient_per_m z^2, both positive.
  [[nodiscard]] static DepthNoise of(double constant_m, double coefficient_per_m) {
    return {coefficient_per_m, std::sqrt(constant_m / coefficient_per_m)};
  }

  /// Standard deviation of depth.
  [[nodiscard]] double sigma_m(double depth_m) const {
    return coefficient_per_m * depth_m * depth_m + coefficient_per_m * crossover_m * crossover_m;
  }

  /// Standard deviation of inverse depth, 1/m: sigma_z / z^2.
  [[nodiscard]] double inverse_sigma_per_m(double inverse_depth_per_m) const {
    const double share = crossover_m * inverse_depth_per_m;
    return coefficient_per_m * (1 + share * share);
  }

  /// Standard deviation of the difference of two measured depths.
  [[nodiscard]] double difference_sigma_m(double depth_a_m, double depth_b_m) const {
    const double squared_m2 = crossover_m * crossover_m;
    return coefficient_per_m *
           std::hypot(depth_a_m * depth_a_m + squared_m2, depth_b_m * depth_b_m + squared_m2);
  }

  /// Returns the same law, `factor` times as strong.
  [[nodiscard]] DepthNoise times(double factor) const { return {coefficient_per_m * factor, crossover_m}; }
};

}  // namespace kinloop
