#pragma once
// What writer and reader of recorded frames share: the constants of MCAP files (mcap.dev/spec) and the
// topics. A recording is an MCAP file of ROS 2 messages. The two images of a frame have the same log time,
// that of colour, and each its own stamp.

#include <cstdint>
#include <string_view>

namespace kinloop {

/// Begins and ends a file.
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};

enum class McapOpcode : uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

namespace recording {

/// sensor_msgs/CompressedImage: the camera's JPEG, or PNG.
inline constexpr const char* kColorTopic = "/kinloop/color/compressed";
/// sensor_msgs/CompressedImage: width and height (two 32-bit numbers) and 16-bit depth as RVL, in units of
/// camera.yaml. Not named compressedDepth, since ROS takes 16-bit depth for millimetres.
inline constexpr const char* kDepthTopic = "/kinloop/depth/rvl";
/// std_msgs/String: camera.yaml.
inline constexpr const char* kCameraTopic = "/kinloop/camera_yaml";
/// sensor_msgs/CameraInfo, for other programs.
inline constexpr const char* kCameraInfoTopic = "/kinloop/color/camera_info";

}  // namespace recording
}  // namespace kinloop
