#pragma once
// In: a bag recorded by the RealSense SDK (topics /device_0/sensor_1/Color_0/image/data, ...): .bag, since
// version 2.58 .db3. Out: its streams and its camera, without the SDK.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "drivers/bags/message_file.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "drivers/ros/messages/ros_topics.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

// In: the text messages (std_msgs/String) of the RealSense SDK's recordings since version 2.58, such as
// "width=640;height=480;fx=615.3". Out: what they say. Each throws InputError if it is not that.

/// The lens of a stream: width, height, fx, ppx, fy, ppy, model, coeffs.
RosCameraInfo sdk_camera_info(std::string_view text);

/// T_stream_reference of "rotation=...;translation=...": nine numbers by columns, three in metres.
SE3 sdk_pose(std::string_view text);

/// The camera's stamp of an image, from its metadata ("timestamp=1700000000033.333252;" in milliseconds).
int64_t sdk_stamp_ns(std::string_view text);

/// A text that is one number.
double sdk_number(std::string_view text);

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
