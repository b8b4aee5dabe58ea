#pragma once
// In: the content of ROS image messages (sensor_msgs), from a bag or a node. Out: colour and depth in
// kinloop's formats. Independent of ROS headers.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/color_image.hpp"

namespace kinloop {

/// sensor_msgs/Image; does not own the data.
struct RosImage {
  int width = 0, height = 0;
  size_t step = 0;  ///< bytes per row
  std::string encoding;
  bool big_endian = false;
  std::span<const uint8_t> data;
};

/// Converts bgr8, rgb8, bgra8, rgba8, mono8, 8UC1 or 8UC3 to 8UC3 BGR. Throws InputError for other encodings
/// and for truncated data.
cv::Mat color_from(const RosImage& image);

/// Converts 16UC1 or mono16 (millimetres) and 32FC1 (metres; NaN = unknown) to 32FC1 metres, as in REP 118.
cv::Mat depth_from(const RosImage& image);

/// Same for sensor_msgs/CompressedImage: JPEG or PNG; depth as 16-bit PNG, preceded by the header of
/// compressed_depth_image_transport if `format` says so.
ColorImage color_from_compressed(std::span<const uint8_t> data);
cv::Mat depth_from_compressed(const std::string& format, std::span<const uint8_t> data);

/// sensor_msgs/CameraInfo.
struct RosCameraInfo {
  int width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{};
  std::array<double, 12> P{};
};

/// Returns the camera of a raw image, or of a rectified one (projection matrix, no distortion). Throws
/// InputError if the camera is uncalibrated or its distortion model is not plumb_bob.
PinholeCamera camera_from(const RosCameraInfo& info, bool rectified);

}  // namespace kinloop
