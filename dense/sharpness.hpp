#pragma once

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns the sharpness of a colour image: the mean square of its Laplacian, in thousands of squared
/// intensities; low under motion blur.
float image_sharpness(const cv::Mat& color);

/// Returns how much of the contrast of a colour image is fine, from 0 (blurred in some direction) to 1: the
/// share of its gradient that a mean over 9 pixels along a row, or along a column, takes away, the lower of
/// both. It depends little on what the image shows (Crete et al., "The blur effect", 2007).
float fine_contrast(const cv::Mat& color);

}  // namespace kinloop
