#pragma once
// In: an image with gaps. Out: the same without.

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Fills what is not painted with the mean colour around it, from the nearest on (push and pull, Gortler et
/// al. 1996), so that smaller versions of an atlas show no seams. `image` is 8UC3, `painted` 8UC1 of 0 and
/// 255.
void fill_gaps(cv::Mat& image, const cv::Mat& painted);

}  // namespace kinloop
