#pragma once
// Motion compensation (deskewing): converts keypoints measured by a moving rolling-shutter camera to those of
// an ideal static camera at the time of the middle row. Later stages then need not model the row-wise
// exposure and the depth delay.

#include <optional>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/sensor_model.hpp"

namespace kinloop {

/// Returns whether motion displaces the measurements: false for an ideal camera whose images are of one time.
bool needs_deskewing(const Features& features, const SensorVector& sensor);

/// Returns `features` with `pixels` and `depths_m` recomputed from the measurements, for a camera that
/// deviates from `camera` by `sensor` and moves with `velocity`: the inverse of the model used by bundle
/// adjustment. Keypoints without depth are only rotated, since the effect of translation depends on their
/// distance.
Features deskew_features(const Features& features, const PinholeCamera& camera, const SensorVector& sensor,
                         const Velocity& velocity);

/// Returns the raw pixel at which a moving camera sees a point given in camera axes at the frame's stamp: the
/// inverse of `deskew_features` for a pixel. nullopt if the point is behind the camera.
std::optional<Eigen::Vector2d> raw_pixel_of(const Eigen::Vector3d& p_camera, const PinholeCamera& camera,
                                            const SensorVector& sensor, const Velocity& velocity);

}  // namespace kinloop
