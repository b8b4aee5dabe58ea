#pragma once
// The smoothing that comes before the comparisons of BRIEF.

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kBlurRadius = 3;  ///< the rim that `gaussian_blur` does not compute, px

/// Gaussian of 7 x 7 and sigma 2, as cv::ORB takes it. The rim of 3 pixels and images narrower than 22 pixels
/// are left as they are.
cv::Mat gaussian_blur(const cv::Mat& image);

}  // namespace kinloop
