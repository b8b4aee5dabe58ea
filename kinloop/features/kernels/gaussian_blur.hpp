#pragma once
// The smoothing that precedes the BRIEF comparisons.

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kBlurRadius = 3;  ///< width of the border that `gaussian_blur` leaves unchanged, px

/// Gaussian blur of 7 x 7 and sigma 2, as in cv::ORB. The border of 3 pixels and images narrower than 22
/// pixels stay unchanged.
cv::Mat gaussian_blur(const cv::Mat& image);

}  // namespace kinloop
