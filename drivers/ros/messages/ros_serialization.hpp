#pragma once
// In: a serialised ROS message (ROS 1, or CDR as in ROS 2). Out: its content. Independent of ROS headers.

#include <string>
#include <string_view>
#include <vector>

#include "drivers/ros/messages/ros_image.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// std_msgs/Header.
struct RosHeader {
  int64_t stamp_ns = 0;
  std::string frame_id;
};

/// sensor_msgs/Image with its header; the pixels stay in the message.
struct StampedImage {
  RosHeader header;
  RosImage image;
  Bytes after;  ///< what follows the message proper
};

/// sensor_msgs/CompressedImage; the data stay in the message.
struct StampedCompressedImage {
  RosHeader header;
  std::string format;
  Bytes data;
};

/// sensor_msgs/CameraInfo with its header.
struct StampedCameraInfo {
  RosHeader header;
  RosCameraInfo info;
};

/// geometry_msgs/TransformStamped.
struct StampedTransform {
  RosHeader header;  ///< frame_id is the parent
  std::string child;
  SE3 T_parent_child;
};

/// Reads the fields of a message: ROS 1 has no padding; CDR aligns each number to its size and has either
/// byte order. Throws InputError at the end of the message.
class RosReader {
 public:
  /// `encoding` is that of a BagTopic, ros1 or cdr.
  RosReader(Bytes message, std::string_view encoding);

  template <class Number>
  Number number() {
    align(sizeof(Number));
    const Number value = reader_.number<Number>();
    return swapped_ ? byte_swapped(value) : value;
  }
  std::string string();
  Bytes bytes();  ///< uint8[]
  [[nodiscard]] Bytes rest() const { return Bytes(message_).last(reader_.left()); }
  RosHeader header();

 private:
  void align(size_t size);

  Bytes message_;
  ByteReader reader_;
  bool cdr_, swapped_ = false;
  size_t max_alignment_ = 8;
};

/// Each throws InputError if the message is truncated or cannot be what it should be.
StampedImage read_image(RosReader reader);
StampedCompressedImage read_compressed_image(RosReader reader);
StampedCameraInfo read_camera_info(RosReader reader);
std::vector<StampedTransform> read_transforms(RosReader reader);

/// geometry_msgs/Transform.
SE3 read_transform(RosReader& reader);

}  // namespace kinloop
