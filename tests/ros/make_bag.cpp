// make_bag FOLDER FILE.bag: converts a sequence in TUM layout to a bag on the topics of iai_kinect2, for
// tests.

#include <cstdio>

#include <opencv2/core.hpp>
#include <rosbag/bag.h>

#include "drivers/datasets/tum_source.hpp"
#include "drivers/ros/messages/ros_messages.hpp"
#include "drivers/ros/messages/ros_topics.hpp"

namespace kinloop {
namespace {

ros1::Image message_of(int64_t stamp_ns, const cv::Mat& image, const char* encoding) {
  ros1::Image message;
  message.header.stamp.fromNSec(static_cast<uint64_t>(stamp_ns));
  message.width = static_cast<uint32_t>(image.cols);
  message.height = static_cast<uint32_t>(image.rows);
  message.step = static_cast<uint32_t>(image.step);
  message.encoding = encoding;
  message.data.assign(image.data, image.data + image.step * static_cast<size_t>(image.rows));
  return message;
}

ros1::CameraInfo info_of(int64_t stamp_ns, const PinholeCamera& c) {
  ros1::CameraInfo info;
  info.header.stamp.fromNSec(static_cast<uint64_t>(stamp_ns));
  info.width = static_cast<uint32_t>(c.width);
  info.height = static_cast<uint32_t>(c.height);
  info.distortion_model = "plumb_bob";
  info.K[0] = info.P[0] = c.fx;
  info.K[2] = info.P[2] = c.cx;
  info.K[4] = info.P[5] = c.fy;
  info.K[5] = info.P[6] = c.cy;
  info.K[8] = info.P[10] = 1;
  return info;
}

void make_bag(const char* folder, const char* file) {
  const RosTopics& topics = known_topics()[0];
  TumSource source(folder);
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  while (const auto frame = source.next()) {
    const ros1::Image color = message_of(frame->stamp_ns, frame->color.bgr(), "bgr8");
    bag.write(topics.info, color.header.stamp, info_of(frame->stamp_ns, source.camera().color));
    bag.write(topics.color, color.header.stamp, color);
    const ros1::Image depth = message_of(frame->depth_stamp_or_color_ns(), frame->depth_m, "32FC1");
    bag.write(topics.depth, depth.header.stamp, depth);
  }
  bag.close();
}

}  // namespace
}  // namespace kinloop

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    kinloop::make_bag(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
  return 0;
}
