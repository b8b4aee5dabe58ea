#pragma once
// In: the text messages (std_msgs/String) of the RealSense SDK's recordings since version 2.58, such as
// "width=640;height=480;fx=615.3". Out: what they say. Each throws InputError if it is not that.

#include <cstdint>
#include <string_view>

#include "drivers/ros/ros_image.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// The lens of a stream: width, height, fx, ppx, fy, ppy, model, coeffs.
RosCameraInfo sdk_camera_info(std::string_view text);

/// T_stream_reference of "rotation=...;translation=...": nine numbers by columns, three in metres.
SE3 sdk_pose(std::string_view text);

/// The camera's stamp of an image, from its metadata ("timestamp=1700000000033.333252;" in milliseconds).
int64_t sdk_stamp_ns(std::string_view text);

/// A text that is one number.
double sdk_number(std::string_view text);

}  // namespace kinloop
