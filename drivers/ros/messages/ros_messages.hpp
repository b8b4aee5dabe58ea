#pragma once
// ROS 1 message classes for C++20, and conversion to `RosImage` and `RosCameraInfo`. Requires ROS headers;
// for the bag reader, the node and their tests.

#include <algorithm>
#include <memory>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include "drivers/ros/messages/ros_image.hpp"

namespace kinloop::ros1 {

/// std::allocator with the member that C++20 removed and ROS 1 messages still use.
template <class T>
struct Allocator : std::allocator<T> {
  template <class U>
  struct rebind {  // NOLINT(readability-identifier-naming): required by the messages
    using other = Allocator<U>;
  };
  Allocator() = default;
  template <class U>
  Allocator(const Allocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor): as in std::allocator
};
template <>
struct Allocator<void> {
  using value_type = void;
  template <class U>
  struct rebind {  // NOLINT(readability-identifier-naming)
    using other = Allocator<U>;
  };
};

using Image = sensor_msgs::Image_<Allocator<void>>;
using CompressedImage = sensor_msgs::CompressedImage_<Allocator<void>>;
using CameraInfo = sensor_msgs::CameraInfo_<Allocator<void>>;

inline RosImage from_message(const Image& m) {
  return {static_cast<int>(m.width), static_cast<int>(m.height), m.step,
          m.encoding.c_str(),        m.is_bigendian != 0,        m.data};
}

inline RosCameraInfo from_message(const CameraInfo& m) {
  RosCameraInfo info;
  info.width = static_cast<int>(m.width);
  info.height = static_cast<int>(m.height);
  info.distortion_model = m.distortion_model.c_str();
  info.D.assign(m.D.begin(), m.D.end());
  std::copy(m.K.begin(), m.K.end(), info.K.begin());
  std::copy(m.P.begin(), m.P.end(), info.P.begin());
  return info;
}

/// Stamp of a message's header, nanoseconds since the epoch.
template <class Message>
int64_t stamp_ns(const Message& message) {
  return static_cast<int64_t>(message.header.stamp.toNSec());
}

}  // namespace kinloop::ros1
