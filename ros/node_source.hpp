#pragma once
// In: topics of an RGB-D camera. Out: its frames.

#include <optional>
#include <string>

#include <ros/node_handle.h>

#include "drivers/live/live_frames.hpp"
#include "drivers/ros/ros_messages.hpp"
#include "drivers/ros/ros_topics.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop::ros1 {

/// Configuration of the subscription.
struct ListenOptions {
  std::optional<RosTopics> topics;   ///< default: the first known camera that publishes
  std::optional<RgbdCamera> camera;  ///< default: camera_info
  bool keep_all = false;             ///< drops no frame, however late; for playing bags
  double idle_s = 0;                 ///< end after this time without a frame; 0 = only by Ctrl-C
};

/// Associates colour and depth by time stamp. Another thread must serve the callbacks.
class TopicSource : public FrameSource {
 public:
  /// Waits for the topics and the camera. Throws InputError if ROS is shut down meanwhile.
  TopicSource(ros::NodeHandle node, const ListenOptions& options);

  std::optional<Frame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override;

 private:
  void on_color(const boost::shared_ptr<const Image>& message);
  void on_depth(const boost::shared_ptr<const Image>& message);
  void skip(const std::string& topic, const std::string& reason);

  ListenOptions options_;
  RosTopics topics_;
  RgbdCamera camera_;
  SourceInfo info_;
  LiveFrameBuffer frames_;
  bool ended_ = false;  ///< no images came for `idle_s`
  mutable std::mutex skipped_mutex_;
  SkippedFrames skipped_;
  ros::Subscriber color_, depth_;
};

}  // namespace kinloop::ros1
