#pragma once
// In: an image. Out: a PNG file, by libdeflate at its lightest: a third of the time that OpenCV takes for the
// same size.

#include <string>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// The bytes of a PNG file of an 8UC1, 8UC3 (BGR) or 16UC1 image.
std::string encode_png(const cv::Mat& image);

}  // namespace kinloop
