#pragma once
// In: the features of an image. Out: one keypoint of them as the estimators take it.

#include "kinloop/features/features.hpp"
#include "kinloop/sensor/keypoint_measurement.hpp"

namespace kinloop {

/// The keypoint as an ideal camera at rest would have measured it at the stamp: row, gradient and stamp
/// difference are zero.
KeypointMeasurement compensated_measurement(const Features& features, size_t index);

/// The keypoint as the camera measured it in motion, with the row of an image of `image_height_px` rows.
KeypointMeasurement raw_measurement(const Features& features, size_t index, int image_height_px);

}  // namespace kinloop
