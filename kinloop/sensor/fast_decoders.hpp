#pragma once
// In: the bytes of an image file. Out: its pixels, for the two kinds of file that recordings consist of, in
// about half the time of OpenCV's readers.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// A JPEG file as 8UC3 BGR, by libjpeg-turbo, which gives that order at once. Empty where the file is damaged
/// or not one that it can turn into BGR.
cv::Mat decode_jpeg(std::string_view bytes);

/// A PNG file of 16-bit grey without interlacing as 16UC1, inflated by libdeflate. Empty where the file is
/// damaged or another kind of PNG.
cv::Mat decode_depth_png(std::string_view bytes);

}  // namespace kinloop
