#pragma once
// In: keypoints as a moving, rolling camera measured them, and how it moved. Out: the same keypoints as an
// ideal camera at rest would have seen them at the time of the middle row. Everything behind it can then
// forget that rows are exposed one after the other and depth comes later than colour.

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/optimize/bundle/sensor_model.hpp"

namespace kinloop {

/// `features` with `pixels` and `depths_m` worked out anew from what was measured, for a camera whose sensor
/// departs from `camera` as `sensor` says, moving with `velocity`: the inverse of the model that bundle
/// adjustment predicts with. Keypoints without depth are turned, not shifted: what the camera's translation
/// does to them depends on their distance.
Features deskew_features(const Features& features, const PinholeCamera& camera, const SensorVector& sensor,
                         const Velocity& velocity);

}  // namespace kinloop
