#pragma once

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns the sharpness of a colour image: the mean square of its Laplacian, in thousands of squared
/// intensities; low under motion blur.
float image_sharpness(const cv::Mat& color);

}  // namespace kinloop
