#pragma once
// In: the bytes of a PNG file. Out: its pixels, in about half the time of OpenCV's reader.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Decodes a non-interlaced 16-bit grey PNG file to 16UC1, inflating with libdeflate. Empty if the file is
/// damaged or another kind of PNG.
cv::Mat decode_depth_png(std::string_view bytes);

}  // namespace kinloop
