#include "kinloop/sensor/sensor_estimate.hpp"

#include <algorithm>

namespace kinloop {

SensorEstimate nominal_estimate(const Sensor& sensor) {
  return {sensor, sensor.corrections};
}

SensorEstimate with_fixed_from(SensorEstimate estimate, const SensorEstimate& before) {
  for (int k = 0; k < kSensorParameterCount; ++k) {
    if (estimate.sigma(k) > 0) continue;  // this parameter was estimated
    estimate.sigma(k) = before.sigma(k);
    estimate.used[static_cast<size_t>(k)] = before.used[static_cast<size_t>(k)];
  }
  return estimate;
}

RgbdCamera calibrated_camera(const RgbdCamera& camera, const SensorEstimate& estimate) {
  RgbdCamera calibrated = camera;
  const bool lens_found = std::any_of(estimate.used.begin(), estimate.used.begin() + kRollingShutter,
                                      [](bool used) { return used; });
  if (lens_found) calibrated.color = corrected_camera({camera.color, {}, estimate.sensor.corrections});
  calibrated.rolling_shutter_s = estimate.sensor.corrections(kRollingShutter);
  calibrated.depth_delay_s = estimate.sensor.corrections(kDepthDelay);
  return calibrated;
}

}  // namespace kinloop
