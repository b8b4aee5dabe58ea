#pragma once
// In: raw images. Out: those of an ideal camera.

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Returns the raw pixel of each pixel of an ideal camera, for `undistorted`; empty if the lens has no
/// distortion.
cv::Mat undistortion_of(const PinholeCamera& camera);

/// Returns the image of an ideal camera. Interpolating depth between two surfaces would give a depth of
/// neither, so it takes the nearest pixel.
cv::Mat undistorted(const cv::Mat& image, const cv::Mat& raw_pixels);

}  // namespace kinloop
