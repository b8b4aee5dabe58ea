#pragma once
// In: the bytes of an image file. Out: its pixels, for the two formats that recordings use, in about half the
// time of OpenCV's readers.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Decodes a JPEG file to 8UC3 BGR with libjpeg-turbo. Empty if the file is damaged or cannot be converted to
/// BGR.
cv::Mat decode_jpeg(std::string_view bytes);

/// Decodes a non-interlaced 16-bit grey PNG file to 16UC1, inflating with libdeflate. Empty if the file is
/// damaged or another kind of PNG.
cv::Mat decode_depth_png(std::string_view bytes);

}  // namespace kinloop
