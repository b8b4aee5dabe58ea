#include "kinloop/sensor/sensor_estimate.hpp"

#include <algorithm>

namespace kinloop {

SensorEstimate nominal_estimate(const Sensor& sensor) {
  return {sensor, sensor.corrections};
}

SensorEstimate nominal_estimate(const RgbdCamera& camera, const NoiseOptions& noise) {
  SensorEstimate estimate = nominal_estimate(make_sensor(camera, noise));
  if (camera.rolling_shutter_s) return estimate;
  estimate.typical_sigma(kRollingShutter) = camera.sensor.typical_readout_sigma_s;
  if (camera.sensor.kind == DepthSensorKind::kStructuredLight)
    estimate.typical_sigma(kDepthShutter) = camera.sensor.typical_readout_sigma_s;
  return estimate;
}

SensorEstimate with_fixed_from(SensorEstimate estimate, const SensorEstimate& before) {
  for (int k = 0; k < kSensorParameterCount; ++k) {
    if (estimate.sigma(k) > 0) continue;  // this parameter was estimated
    estimate.sigma(k) = before.sigma(k);
    estimate.used[static_cast<size_t>(k)] = before.used[static_cast<size_t>(k)];
  }
  estimate.typical_sigma = before.typical_sigma;
  return estimate;
}

RgbdCamera calibrated_camera(const RgbdCamera& camera, const SensorEstimate& estimate) {
  RgbdCamera calibrated = camera;
  const bool lens_found = std::any_of(estimate.used.begin(), estimate.used.begin() + kRollingShutter,
                                      [](bool used) { return used; });
  if (lens_found) calibrated.color = corrected_camera({camera.color, {}, estimate.sensor.corrections});
  const double readout_s = estimate.sensor.corrections(kRollingShutter);
  if (readout_s != nominal_readout_s(camera)) calibrated.rolling_shutter_s = readout_s;
  calibrated.depth_delay_s = estimate.sensor.corrections(kDepthDelay);
  return calibrated;
}

}  // namespace kinloop
