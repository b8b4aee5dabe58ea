#pragma once
// Motion compensation (deskewing): converts keypoints measured by a moving rolling-shutter camera to those of
// an ideal static camera at the time of the middle row. Later stages then need not model the row-wise
// exposure and the depth delay.

#include "kinloop/features/features.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Returns whether motion displaces the measurements: false for an ideal camera whose images are taken at the
/// same time.
bool needs_deskewing(const Features& features, const Sensor& sensor);

/// Returns `features` with `pixels` and `depths_m` recomputed from the measurements, for a sensor that moves
/// with `velocity`: the inverse of the model used by bundle adjustment. Keypoints without depth are only
/// rotated, since the effect of translation depends on their distance.
Features deskew_features(const Features& features, const Sensor& sensor, const Velocity& velocity);

}  // namespace kinloop
