#pragma once
// In: a bag recorded by the RealSense SDK (topics /device_0/sensor_1/Color_0/image/data, ...): .bag, since
// version 2.58 .db3. Out: its streams and its camera, without the SDK.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

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

/// The camera's stamps of images, by image topic and the recorder's stamp.
using SdkStamps = std::map<std::string, std::map<int64_t, int64_t>>;

/// Reads them from the metadata of a .db3, whose images have the time since the recording began. Empty for a
/// .bag, whose images have the camera's stamps.
SdkStamps read_realsense_stamps(MessageFile& file, const BagStreams& streams);

/// Returns the exact unit: the SDK stores a float, and means 0.001 where it writes 0.0010000000475.
double unit_m_of_sdk(double unit_m);

}  // namespace kinloop
