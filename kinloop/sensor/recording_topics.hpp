#pragma once
// What writer and reader of recorded frames share. A recording is an MCAP file of ROS 2 messages. The two
// images of a frame have the same log time, that of colour, and each its own stamp.

namespace kinloop::recording {

/// sensor_msgs/CompressedImage: the camera's JPEG, or PNG.
inline constexpr const char* kColorTopic = "/kinloop/color/compressed";
/// sensor_msgs/CompressedImage: width and height (two 32-bit numbers) and 16-bit depth as RVL, in units of
/// camera.yaml. Not named compressedDepth, since ROS takes 16-bit depth for millimetres.
inline constexpr const char* kDepthTopic = "/kinloop/depth/rvl";
/// std_msgs/String: camera.yaml.
inline constexpr const char* kCameraTopic = "/kinloop/camera_yaml";
/// sensor_msgs/CameraInfo, for other programs.
inline constexpr const char* kCameraInfoTopic = "/kinloop/color/camera_info";

}  // namespace kinloop::recording
