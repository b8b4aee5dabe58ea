#include "kinloop/sensor/noise_model.hpp"

namespace kinloop {

NoiseModel make_noise_model(const NoiseOptions& options, const DepthNoise& plane) {
  const double sensor_ratio = plane.coefficient_per_m / kSensorInverseDepthSigmaPerM;
  const double keypoint_ratio = options.inverse_depth_sigma_per_m / kKeypointInverseDepthSigmaPerM;
  NoiseModel noise;
  noise.plane = plane;
  noise.keypoint = {options.inverse_depth_sigma_per_m * sensor_ratio, plane.crossover_m};
  noise.point_pair = {kPointPairInverseDepthSigmaPerM * keypoint_ratio * sensor_ratio, plane.crossover_m};
  noise.surface = plane.times(keypoint_ratio);
  noise.robust_width = options.robust_width;
  noise.inlier_chi2_pixel = options.inlier_chi2_pixel;
  noise.inlier_chi2_depth = options.inlier_chi2_depth;
  return noise;
}

}  // namespace kinloop
