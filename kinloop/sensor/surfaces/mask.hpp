#pragma once
// Masks of images: 8UC1, 0 = to be ignored, anything else = used; an empty one uses all.

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns the mask of what both use. Masks that are not empty must have the same size.
cv::Mat intersection_of_masks(const cv::Mat& a, const cv::Mat& b);

}  // namespace kinloop
