#pragma once
// In: the content of ROS image messages (sensor_msgs), from a bag or a node. Out: colour and depth in
// kinloop's formats. Independent of ROS headers.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/images/color_image.hpp"

namespace kinloop {

/// sensor_msgs/Image; does not own the data.
struct RosImage {
  int width = 0, height = 0;
  size_t step = 0;  ///< bytes per row
  std::string encoding;
  bool big_endian = false;
  std::span<const uint8_t> data;
};

constexpr double kRosDepthUnitM = 0.001;  ///< of 16-bit depth (REP 118)

/// Converts bgr8, rgb8, bgra8, rgba8, mono8, 8UC1, 8UC3, 8UC4, UYVY and YUYV to 8UC3 BGR. Throws InputError
/// for other encodings and for truncated data.
cv::Mat color_from(const RosImage& image);

/// Converts 16UC1 or mono16 (in units of `unit_m`) and 32FC1 (metres; unknown if not finite and positive),
/// both of either byte order, to 32FC1 metres.
cv::Mat depth_from(const RosImage& image, double unit_m = kRosDepthUnitM);

/// Same for sensor_msgs/CompressedImage: JPEG or PNG; depth as 16-bit PNG, or in the formats of
/// compressed_depth_image_transport if `format` says so: 16-bit PNG, 32-bit depth as 16-bit PNG of quantised
/// inverse depth, and RVL, each behind its header.
/// Compare `compressed_size` with the camera first: a small message may hold a huge image.
ColorImage color_from_compressed(std::span<const uint8_t> data);
cv::Mat depth_from_compressed(const std::string& format, std::span<const uint8_t> data,
                              double unit_m = kRosDepthUnitM);

/// Returns the size of the image in a sensor_msgs/CompressedImage, without decoding it; nullopt if it cannot
/// be decoded.
std::optional<cv::Size> compressed_size(const std::string& format, std::span<const uint8_t> data);

/// sensor_msgs/CameraInfo.
struct RosCameraInfo {
  int width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{};
  std::array<double, 12> P{};
};

/// Returns the camera of a raw image, or of a rectified one (projection matrix, no distortion). The
/// RealSense's inverse and modified Brown-Conrady distortion is approximated by ours. Throws InputError if
/// the camera is uncalibrated or has another distortion model.
PinholeCamera camera_from(const RosCameraInfo& info, bool rectified);

}  // namespace kinloop
