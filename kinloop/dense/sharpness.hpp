#pragma once

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// How sharp a colour image is: the mean square of its Laplacian, in thousands of squared intensities; motion
/// blur takes it away.
float image_sharpness(const cv::Mat& color);

}  // namespace kinloop
