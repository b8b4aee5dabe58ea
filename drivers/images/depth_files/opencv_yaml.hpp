#pragma once
// In: a matrix that OpenCV's FileStorage wrote as YAML (.yml). Out: a depth image. Only the one matrix is
// looked for, without a parser of YAML, which would need a hundred bytes per pixel.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

bool is_opencv_yaml(std::string_view bytes);
cv::Size opencv_yaml_size(std::string_view bytes);

/// Decodes the first matrix of one channel: of uint16 (dt: w) to 16UC1, all else to 32FC1. Throws InputError.
cv::Mat decode_opencv_yaml(std::string_view bytes);

}  // namespace kinloop
