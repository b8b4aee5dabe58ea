#include "kinloop/sensor/noise_options.hpp"

namespace kinloop {

DepthNoise keypoint_noise(const NoiseOptions& noise, const DepthNoise& sensor_noise) {
  const double sensor_ratio = sensor_noise.coefficient_per_m / kSensorInverseDepthSigmaPerM;
  return {noise.inverse_depth_sigma_per_m * sensor_ratio, sensor_noise.crossover_m};
}

}  // namespace kinloop
