#include "drivers/ros/ros_image.hpp"

#include <bit>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/sensor/image_file.hpp"

namespace kinloop {
namespace {

constexpr double kMillimetresPerMetre = 1000;

/// Wraps the message's pixels. `type` is an OpenCV type.
cv::Mat pixels_of(const RosImage& image, int type) {
  const size_t row = static_cast<size_t>(image.width) * CV_ELEM_SIZE(type);
  const bool fits = image.width > 0 && image.height > 0 && image.step >= row &&
                    image.data.size() >= image.step * static_cast<size_t>(image.height);
  if (!fits) {
    throw InputError(fmt::format("an image message of {} x {} pixels with {} bytes: truncated", image.width,
                                 image.height, image.data.size()));
  }
  if (image.big_endian != (std::endian::native == std::endian::big) && CV_ELEM_SIZE1(type) > 1) {
    throw InputError("big-endian image messages are not supported");
  }
  return {image.height, image.width, type, const_cast<uint8_t*>(image.data.data()), image.step};
}

cv::Mat converted(const cv::Mat& pixels, int code) {
  cv::Mat color;
  cv::cvtColor(pixels, color, code);
  return color;
}

[[noreturn]] void reject(const std::string& encoding, const char* known) {
  throw InputError(fmt::format("unknown encoding '{}'; expected one of {}", encoding, known));
}

cv::Mat metres_from_millimetres(const cv::Mat& millimetres) {
  cv::Mat depth_m;
  millimetres.convertTo(depth_m, CV_32FC1, 1 / kMillimetresPerMetre);
  return depth_m;
}

std::string_view bytes_of(std::span<const uint8_t> data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

cv::Mat decoded(std::span<const uint8_t> data) {
  cv::Mat image = decode_image(bytes_of(data));
  if (image.empty()) throw InputError("a compressed image message cannot be decoded");
  return image;
}

}  // namespace

cv::Mat color_from(const RosImage& image) {
  const std::string& e = image.encoding;
  if (e == "bgr8" || e == "8UC3") return pixels_of(image, CV_8UC3).clone();
  if (e == "rgb8") return converted(pixels_of(image, CV_8UC3), cv::COLOR_RGB2BGR);
  if (e == "bgra8" || e == "8UC4") return converted(pixels_of(image, CV_8UC4), cv::COLOR_BGRA2BGR);
  if (e == "rgba8") return converted(pixels_of(image, CV_8UC4), cv::COLOR_RGBA2BGR);
  if (e == "mono8" || e == "8UC1") return converted(pixels_of(image, CV_8UC1), cv::COLOR_GRAY2BGR);
  reject(e, "bgr8, rgb8, bgra8, rgba8, mono8");
}

cv::Mat depth_from(const RosImage& image) {
  const std::string& e = image.encoding;
  if (e == "16UC1" || e == "mono16") return metres_from_millimetres(pixels_of(image, CV_16UC1));
  if (e == "32FC1") {
    cv::Mat depth_m = pixels_of(image, CV_32FC1).clone();
    cv::patchNaNs(depth_m, 0);
    return depth_m;
  }
  reject(e, "16UC1, 32FC1");
}

ColorImage color_from_compressed(std::span<const uint8_t> data) {
  if (auto jpeg = ColorImage::from_jpeg(std::string(bytes_of(data)))) return *std::move(jpeg);
  cv::Mat image = decoded(data);
  if (image.type() == CV_8UC3) return image;
  if (image.type() == CV_8UC1) return converted(image, cv::COLOR_GRAY2BGR);
  throw InputError("a compressed colour image does not have 8 bits per channel");
}

cv::Mat depth_from_compressed(const std::string& format, std::span<const uint8_t> data) {
  constexpr size_t kHeaderBytes =
      12;  // compressed_depth_image_transport: format and two quantisation parameters
  const bool has_header = format.find("compressedDepth") != std::string::npos;
  if (has_header && data.size() < kHeaderBytes) throw InputError("a compressed depth message is truncated");
  const cv::Mat image = decoded(has_header ? data.subspan(kHeaderBytes) : data);
  if (image.type() != CV_16UC1 || format.starts_with("32FC1")) {
    throw InputError(fmt::format("compressed depth '{}'; only 16UC1 in millimetres is supported", format));
  }
  return metres_from_millimetres(image);
}

PinholeCamera camera_from(const RosCameraInfo& info, bool rectified) {
  PinholeCamera camera;
  camera.width = info.width, camera.height = info.height;
  if (rectified && info.P[0] > 0) {
    camera.fx = info.P[0], camera.fy = info.P[5], camera.cx = info.P[2], camera.cy = info.P[6];
  } else {
    camera.fx = info.K[0], camera.fy = info.K[4], camera.cx = info.K[2], camera.cy = info.K[5];
  }
  if (!(camera.fx > 0) || !(camera.fy > 0) || camera.width <= 0 || camera.height <= 0) {
    throw InputError("the camera_info message is of an uncalibrated camera; use --camera FILE");
  }
  if (rectified || info.D.empty()) return camera;
  constexpr size_t kPlumbBobSize = 5;
  if ((info.distortion_model != "plumb_bob" && !info.distortion_model.empty()) ||
      info.D.size() > kPlumbBobSize) {
    throw InputError(
        fmt::format("the camera_info message has the distortion model '{}'; only plumb_bob is supported: "
                    "use --camera FILE",
                    info.distortion_model));
  }
  std::array<double, kPlumbBobSize> d{};
  std::copy(info.D.begin(), info.D.end(), d.begin());
  camera.k1 = d[0], camera.k2 = d[1], camera.p1 = d[2], camera.p2 = d[3], camera.k3 = d[4];
  return camera;
}

}  // namespace kinloop
