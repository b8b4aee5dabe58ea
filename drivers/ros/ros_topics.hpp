#pragma once
// The topics of RGB-D cameras, by driver.

#include <array>
#include <string>
#include <string_view>

namespace kinloop {

/// Topics of colour, registered depth and camera calibration.
struct RosTopics {
  std::string color, depth, info;

  /// Returns whether the images are rectified (undistorted), judged by topic name as is usual in ROS.
  [[nodiscard]] bool rectified() const { return color.find("rect") != std::string::npos; }
};

/// Returns the known topics in the order in which they are tried.
inline const std::array<RosTopics, 8>& known_topics() {
  static const std::array<RosTopics, 8> topics = {{
      {"/kinect2/qhd/image_color_rect", "/kinect2/qhd/image_depth_rect", "/kinect2/qhd/camera_info"},
      {"/kinect2/hd/image_color_rect", "/kinect2/hd/image_depth_rect", "/kinect2/hd/camera_info"},
      {"/kinect2/sd/image_color_rect", "/kinect2/sd/image_depth_rect", "/kinect2/sd/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image_raw", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image", "/camera/rgb/camera_info"},
      {"/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw", "/camera/color/camera_info"},
      {"/camera/rgb/image_raw", "/camera/depth_registered/image_raw", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_color", "/camera/depth/image", "/camera/rgb/camera_info"},  // bags of TUM RGB-D
  }};
  return topics;
}

/// Parses "COLOR,DEPTH[,CAMERA_INFO]"; CAMERA_INFO defaults to the one next to the colour topic. Throws
/// UsageError for anything else.
RosTopics parse_topics(std::string_view text);

}  // namespace kinloop
