#include "drivers/openni2/openni_image.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "drivers/images/encoded_image.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {
namespace {

constexpr double kMillimetre = 1e-3, kTenthOfMillimetre = 1e-4;

RosImage with_ros_encoding(const OpenNiImage& image, const char* encoding) {
  return {image.width, image.height, image.stride, encoding, false, image.data};
}

[[noreturn]] void reject_pixels(const char* what, OpenNiPixels pixels) {
  throw InputError(fmt::format("unknown format of {} pixels {}", what, static_cast<uint64_t>(pixels)));
}

ColorImage as_stored_by_openni(const OpenNiImage& image) {
  switch (image.pixels) {
    case OpenNiPixels::kRgb:
      return color_from(with_ros_encoding(image, "rgb8"));
    case OpenNiPixels::kUyvy:
      return color_from(with_ros_encoding(image, "yuv422"));
    case OpenNiPixels::kYuyv:
      return color_from(with_ros_encoding(image, "yuv422_yuy2"));
    case OpenNiPixels::kGray:
      return color_from(with_ros_encoding(image, "mono8"));
    case OpenNiPixels::kJpeg:
      return decode_embedded_color(image.data);
    default:
      reject_pixels("colour", image.pixels);
  }
}

/// Before decoding: a small JPEG may hold a huge image.
void require_expected_size(const OpenNiImage& image) {
  const auto size = encoded_size(as_text(image.data)).value_or(cv::Size());
  if (size == cv::Size(image.width, image.height)) return;
  throw InputError(fmt::format("a JPEG of {} x {} pixels where {} x {} are expected", size.width, size.height,
                               image.width, image.height));
}

}  // namespace

ColorImage color_from(const OpenNiImage& image) {
  if (image.pixels == OpenNiPixels::kJpeg) require_expected_size(image);
  ColorImage color = as_stored_by_openni(image);
  if (!image.mirrored) return color;
  cv::Mat unmirrored;
  cv::flip(color.bgr(), unmirrored, 1);
  return unmirrored;
}

cv::Mat depth_from(const OpenNiImage& image) {
  if (image.pixels != OpenNiPixels::kDepth1Mm && image.pixels != OpenNiPixels::kDepth100Um)
    reject_pixels("depth", image.pixels);
  const double unit_m = image.pixels == OpenNiPixels::kDepth1Mm ? kMillimetre : kTenthOfMillimetre;
  cv::Mat depth_m = depth_from(with_ros_encoding(image, "16UC1"), unit_m);
  if (!image.mirrored) return depth_m;
  cv::Mat unmirrored;
  cv::flip(depth_m, unmirrored, 1);
  return unmirrored;
}

PinholeCamera camera_with_view(const std::string& source, cv::Size size, double horizontal_rad,
                               double vertical_rad) {
  const auto possible = [](double angle_rad) { return angle_rad > 0 && angle_rad < std::numbers::pi; };
  if (!possible(horizontal_rad) || !possible(vertical_rad))
    throw InputError(
        fmt::format("{}: the field of view of colour is not known; use --camera FILE, or --camera freiburg1 "
                    "for a Kinect 1 or Xtion",
                    source));
  PinholeCamera camera;
  camera.width = size.width, camera.height = size.height;
  camera.fx = 0.5 * size.width / std::tan(0.5 * horizontal_rad);
  camera.fy = 0.5 * size.height / std::tan(0.5 * vertical_rad);
  camera.cx = 0.5 * (size.width - 1), camera.cy = 0.5 * (size.height - 1);
  return camera;
}

}  // namespace kinloop
