#include "kinloop/belief/hand_motion.hpp"

#include <cmath>

namespace kinloop {

Vector6d hand_acceleration_noise() {
  // Learned on the simulated rooms 101 to 105 (docs/lab/measurements.md#the-motion-before).
  constexpr double kLinear_m2_s3 = 1, kAngular_rad2_s3 = 5;
  return (Vector6d() << Eigen::Vector3d::Constant(kLinear_m2_s3), Eigen::Vector3d::Constant(kAngular_rad2_s3))
      .finished();
}

Matrix6d hand_motion_covariance(double interval_s, double baseline_s) {
  // The velocity at the end of the baseline differs from its mean by a third of what the walk adds.
  const double growth_s3 = std::pow(interval_s, 3) / 3 + interval_s * interval_s * baseline_s / 3;
  return (growth_s3 * hand_acceleration_noise()).asDiagonal();
}

}  // namespace kinloop
