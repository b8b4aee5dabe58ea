#pragma once
// In: a bag and the topics of its RGB-D camera. Out: the camera.

#include "drivers/bags/message_file.hpp"
#include "drivers/ros/ros_topics.hpp"
#include "kinloop/sensor/rgbd_camera.hpp"

namespace kinloop {

/// Reads the bag up to its calibration: camera_info of colour, and if depth is in another coordinate frame,
/// that of depth and the transform between them (tf_static, else tf). Throws InputError naming the bag and
/// what is missing.
RgbdCamera read_bag_camera(MessageFile& file, const BagStreams& streams, const std::string& name);

}  // namespace kinloop
