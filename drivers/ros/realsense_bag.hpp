#pragma once
// In: a bag recorded by the RealSense SDK (topics /device_0/sensor_1/Color_0/image/data, ...). Out: its
// streams and its camera, without the SDK.

#include "drivers/bags/message_file.hpp"
#include "drivers/ros/ros_topics.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Returns the first colour and depth stream; nullopt if the bag is not of the SDK. Throws InputError if it
/// lacks one of the streams.
std::optional<BagStreams> realsense_streams(const std::set<std::string>& topics, const std::string& name);

/// What the SDK records besides the images.
struct RealsenseCalibration {
  RgbdCamera camera;            ///< with a depth camera, unless both streams have the same pose and lens
  double depth_unit_m = 0.001;  ///< metres per unit of 16-bit depth
};

/// Throws InputError naming the bag and what is missing.
RealsenseCalibration read_realsense_calibration(MessageFile& file, const BagStreams& streams,
                                                const std::string& name);

/// Returns the exact unit: the SDK stores a float, and means 0.001 where it writes 0.0010000000475.
double unit_m_of_sdk(double unit_m);

}  // namespace kinloop
