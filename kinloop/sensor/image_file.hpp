#pragma once
// In: PNG and JPEG files. Out: colour and depth images as the rest of kinloop expects them. A file that is
// truncated is an error here; the decoders alone would hand out the missing part as grey.

#include <filesystem>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/errors.hpp"

namespace kinloop {

/// An intact image that is not what was expected (depth for colour, another size): others of its sequence are
/// likely to be so too.
class ImageFormatError : public InputError {
 public:
  using InputError::InputError;
};

/// A colour image as 8UC3, BGR, from an 8-bit colour or grey PNG or JPEG. Throws InputError naming the file
/// and what is wrong with it.
cv::Mat read_color_image(const std::filesystem::path& path);

/// Depth as 32FC1 metres, 0 = unknown, from a 16-bit grey PNG with `depth_scale` units per metre, in which 0
/// and 65535 mean unknown. Throws InputError naming the file and what is wrong with it.
cv::Mat read_depth_image(const std::filesystem::path& path, double depth_scale);

/// What is wrong with the bytes of a PNG or JPEG file as a whole ("truncated"); empty when nothing is.
std::string_view image_damage(std::string_view bytes);

/// Writes an 8UC1, 8UC3 or 16UC1 image, complete under its name.
void write_png(const std::filesystem::path& path, const cv::Mat& image);

/// Writes depth in `depth_scale` units per metre; 0 where unknown or too far for 16 bits (65535 means unknown
/// to some readers).
void write_depth_png(const std::filesystem::path& path, const cv::Mat& depth_m, double depth_scale);

}  // namespace kinloop
