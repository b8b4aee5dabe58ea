#include <limits>
#include <set>

#include <fmt/format.h>
#include <ros/master.h>
#include <ros/ros.h>
#include <ros/topic.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "ros/node.hpp"

namespace kinloop::ros1 {
namespace {

constexpr double kPollS = 0.5;
constexpr uint32_t kQueue = 1000;  ///< roscpp's queue; excess messages are dropped later, and counted

/// Waits for the first known camera that publishes images.
RosTopics wait_for_topics() {
  bool announced = false;
  while (ros::ok()) {
    ros::master::V_TopicInfo published;
    ros::master::getTopics(published);
    std::set<std::string> names;
    for (const auto& topic : published) names.insert(topic.name);
    for (const RosTopics& topics : known_topics()) {
      if (names.contains(topics.color) && names.contains(topics.depth)) return topics;
    }
    if (!announced) log::info("waiting for the topics of an RGB-D camera, e.g. {}", known_topics()[0].color);
    announced = true;
    ros::WallDuration(kPollS).sleep();
  }
  throw InputError("ROS was shut down before a camera published");
}

RgbdCamera wait_for_camera(ros::NodeHandle& node, const RosTopics& topics) {
  log::info("waiting for {}", topics.info);
  const auto message = ros::topic::waitForMessage<CameraInfo>(topics.info, node);
  if (!message)
    throw InputError(fmt::format("ROS was shut down before a message arrived on {}", topics.info));
  RgbdCamera camera;
  camera.color = camera_from(from_message(*message), topics.rectified());
  return camera;
}

}  // namespace

TopicSource::TopicSource(ros::NodeHandle node, const ListenOptions& options)
    : options_(options),
      topics_(options.topics ? *options.topics : wait_for_topics()),
      frames_(options.keep_all ? std::numeric_limits<size_t>::max() : LiveFrameBuffer::kBuffered) {
  // Subscribes to images first, since a playing bag does not repeat them; they are decoded once the camera is
  // known.
  camera_ = options.camera ? *options.camera : wait_for_camera(node, topics_);
  color_ = node.subscribe(topics_.color, kQueue, &TopicSource::on_color, this);
  depth_ = node.subscribe(topics_.depth, kQueue, &TopicSource::on_depth, this);
  info_.name = topics_.color;
  info_.live = true;
  log::info("listening to {} and {}", topics_.color, topics_.depth);
}

std::optional<Frame> TopicSource::next() {
  constexpr std::chrono::milliseconds kStep(100);
  std::chrono::milliseconds waited(0);
  bool begun = false;
  while (ros::ok() && !ended_) {
    if (auto frame = frames_.wait(kStep)) return frame;
    waited += kStep;
    begun = begun || frames_.delivered() > 0;
    ended_ = options_.idle_s > 0 && begun && static_cast<double>(waited.count()) > 1000 * options_.idle_s;
  }
  frames_.finish();
  return frames_.wait(std::chrono::milliseconds(0));
}

SkippedFrames TopicSource::skipped() const {
  const std::lock_guard lock(skipped_mutex_);
  auto all = skipped_;
  const auto lost = to_skipped_frames(frames_.counts());
  all.add(lost);
  return all;
}

void TopicSource::on_color(const boost::shared_ptr<const Image>& message) {
  try {
    frames_.add_color(stamp_ns(*message), color_from(from_message(*message)));
  } catch (const InputError& error) {
    skip(topics_.color, error.what());
  }
}

void TopicSource::on_depth(const boost::shared_ptr<const Image>& message) {
  try {
    cv::Mat depth_m = depth_from(from_message(*message));
    if (depth_m.cols != camera_.color.width || depth_m.rows != camera_.color.height) {
      throw InputError("depth and colour differ in size; use a topic with depth registered to colour");
    }
    frames_.add_depth(stamp_ns(*message), depth_m);
  } catch (const InputError& error) {
    skip(topics_.depth, error.what());
  }
}

void TopicSource::skip(const std::string& topic, const std::string& reason) {
  const std::lock_guard lock(skipped_mutex_);
  if (skipped_.empty()) log::warn("{}: {}", topic, reason);
  skipped_.add({topic, reason});
}

}  // namespace kinloop::ros1
