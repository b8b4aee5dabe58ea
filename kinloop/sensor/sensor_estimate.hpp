#pragma once
// A sensor whose corrections were estimated, with what is known of their errors.

#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// An estimated sensor. Parameters that the data do not constrain keep their nominal value.
struct SensorEstimate {
  Sensor sensor = {};
  SensorVector nominal = SensorVector::Zero();  ///< the corrections of camera.yaml, the mean of the prior
  /// Standard deviation of each correction; for fixed parameters the value it would have had.
  SensorVector sigma = SensorVector::Zero();
  SensorFlags used{};  ///< which parameters the data constrained
  /// Standard deviation of the nominal corrections that are typical of the kind of sensor; 0 for those that
  /// are calibrated or not known at all.
  SensorVector typical_sigma = SensorVector::Zero();
};

/// Returns the estimate before anything was estimated.
SensorEstimate nominal_estimate(const Sensor& sensor);

/// The same of the sensor of camera.yaml, see make_sensor.
SensorEstimate nominal_estimate(const RgbdCamera& camera, const NoiseOptions& noise = {});

/// Returns `estimate`, with the parameters that were fixed this time taken from `before`.
SensorEstimate with_fixed_from(SensorEstimate estimate, const SensorEstimate& before);

/// Returns `camera` with the estimated lens and times. Omits the depth distortion, which camera.yaml cannot
/// represent.
RgbdCamera calibrated_camera(const RgbdCamera& camera, const SensorEstimate& estimate);

}  // namespace kinloop
