#pragma once
// The topics on which RGB-D cameras publish, by driver.

#include <array>
#include <string>
#include <string_view>

namespace kinloop {

/// Where colour, depth registered to it and the camera's calibration are published.
struct RosTopics {
  std::string color, depth, info;

  /// Rectified images have no distortion left; by their names, as everywhere in ROS.
  [[nodiscard]] bool rectified() const { return color.find("rect") != std::string::npos; }
};

/// Known ones, tried in this order.
inline const std::array<RosTopics, 8>& known_topics() {
  static const std::array<RosTopics, 8> topics = {{
      {"/kinect2/qhd/image_color_rect", "/kinect2/qhd/image_depth_rect", "/kinect2/qhd/camera_info"},
      {"/kinect2/hd/image_color_rect", "/kinect2/hd/image_depth_rect", "/kinect2/hd/camera_info"},
      {"/kinect2/sd/image_color_rect", "/kinect2/sd/image_depth_rect", "/kinect2/sd/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image_raw", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image", "/camera/rgb/camera_info"},
      {"/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw", "/camera/color/camera_info"},
      {"/camera/rgb/image_raw", "/camera/depth_registered/image_raw", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_color", "/camera/depth/image", "/camera/rgb/camera_info"},  // TUM RGB-D's bags
  }};
  return topics;
}

/// Reads "COLOR,DEPTH[,CAMERA_INFO]"; the last is beside the colour topic where it is left out. Throws
/// UsageError for anything else.
RosTopics parse_topics(std::string_view text);

}  // namespace kinloop
