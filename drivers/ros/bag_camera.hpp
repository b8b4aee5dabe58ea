#pragma once
// In: a bag and the topics of its RGB-D camera. Out: the camera.

#include <map>
#include <optional>
#include <string>

#include "drivers/bags/message_file.hpp"
#include "drivers/ros/messages/ros_serialization.hpp"
#include "drivers/ros/messages/ros_topics.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Transforms between named coordinate frames (tf).
class FrameTree {
 public:
  /// The first transform of a pair of frames counts.
  void add(const StampedTransform& transform);

  /// Returns T_a_b; nullopt if no chain of transforms connects the frames.
  [[nodiscard]] std::optional<SE3> between(const std::string& a, const std::string& b) const;

 private:
  std::map<std::string, std::map<std::string, SE3>> T_parent_child_;  ///< both directions of each transform
};

/// Reads the bag up to its calibration: camera_info of colour, and if depth is in another coordinate frame,
/// that of depth and the transform between them (tf_static, else tf). Depth in another coordinate frame is
/// registered all the same if its topic says so, or if it has the intrinsics of colour. Throws InputError
/// naming the bag and what is missing.
RgbdCamera read_bag_camera(MessageFile& file, const BagStreams& streams, const std::string& name);

}  // namespace kinloop
