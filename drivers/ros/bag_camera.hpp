#pragma once
// In: a bag and the topics of its RGB-D camera. Out: the camera.

#include "drivers/bags/message_file.hpp"
#include "drivers/images/rational_lens.hpp"
#include "drivers/ros/ros_topics.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// The camera of a bag; images of a rational lens are to be undistorted, and the camera is that of the
/// results.
struct BagCamera {
  RgbdCamera camera;
  std::optional<RationalCamera> rational_color, rational_depth;
};

/// Reads the bag up to its calibration: camera_info of colour, and if depth is in another coordinate frame,
/// that of depth and the transform between them (tf_static, else tf). Throws InputError naming the bag and
/// what is missing.
BagCamera read_bag_camera(MessageFile& file, const BagStreams& streams, const std::string& name);

}  // namespace kinloop
