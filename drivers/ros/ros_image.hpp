#pragma once
// In: the content of ROS image messages (sensor_msgs), whoever read them: a bag or a node. Out: colour and
// depth as the rest of kinloop expects them. Nothing here needs ROS.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// sensor_msgs/Image; the data is not owned.
struct RosImage {
  int width = 0, height = 0;
  size_t step = 0;  ///< bytes of a row
  std::string encoding;
  bool big_endian = false;
  std::span<const uint8_t> data;
};

/// 8UC3 BGR from bgr8, rgb8, bgra8, rgba8, mono8, 8UC1 or 8UC3. Throws InputError for other encodings and for
/// data that is not as long as it says.
cv::Mat color_from(const RosImage& image);

/// 32FC1 metres from 16UC1 or mono16 (millimetres) and 32FC1 (metres; not a number = unknown), as in REP 118.
cv::Mat depth_from(const RosImage& image);

/// The same from sensor_msgs/CompressedImage: JPEG or PNG; depth as 16-bit PNG behind the header of
/// compressed_depth_image_transport where `format` names it.
cv::Mat color_from_compressed(std::span<const uint8_t> data);
cv::Mat depth_from_compressed(const std::string& format, std::span<const uint8_t> data);

/// sensor_msgs/CameraInfo.
struct RosCameraInfo {
  int width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{};
  std::array<double, 12> P{};
};

/// The camera of a raw image, or of a rectified one (projection matrix, no distortion). Throws InputError for
/// a camera that is not calibrated or has a distortion that is not plumb_bob.
PinholeCamera camera_from(const RosCameraInfo& info, bool rectified);

}  // namespace kinloop
