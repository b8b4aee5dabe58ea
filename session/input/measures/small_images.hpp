#pragma once
// The images of a frame at a small size, for checks that need no details.

#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// Returns the brightness, 8UC1, of a frame that is prepared or not.
cv::Mat gray_of(const Frame& frame);

/// Returns depth in metres at every n-th pixel, 32FC1 of `size`: interpolated depth would have no borders.
cv::Mat sampled_depth(const cv::Mat& depth_m, const cv::Size& size);

}  // namespace kinloop
