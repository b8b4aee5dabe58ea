#pragma once
// The parts of the node: topics of an RGB-D camera as a source of frames, and topics for its results.

#include <optional>
#include <string>

#include <ros/node_handle.h>

#include "drivers/live/live_frames.hpp"
#include "drivers/ros/messages/ros_messages.hpp"
#include "drivers/ros/messages/ros_topics.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop::ros1 {

// In: topics of an RGB-D camera. Out: its frames.

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

// In: the result of each frame. Out: TF, pose, its covariance, path and cloud on topics.

/// Names of the TF frames.
struct TfFrames {
  std::string world = "map", odometry = "odom", camera = "kinloop_camera";  ///< odometry may be empty
};

/// Publishes, in the frame `world`: the camera's pose as TF and on ~pose, after ~doubtful, which tells
/// whether the evidence for that pose is too weak to trust it, and, unless it is or the covariance is
/// unknown, on ~pose_with_covariance, for filters that fuse it with other sensors; with each keyframe, the
/// path so far on ~path and a coloured cloud of the current view on ~cloud. TF is world -> odometry ->
/// camera, of which corrections of the map move only the first (REP 105), or world -> camera without
/// odometry.
class NodeOutput {
 public:
  NodeOutput(ros::NodeHandle node, const PinholeCamera& camera, TfFrames frames);

  /// `result` must not be lost.
  void publish_pose(const TrackedFrame& result);
  void publish_path(const Trajectory& trajectory);
  void publish_cloud(const TrackedFrame& result);

 private:
  void publish_transforms(const TrackedFrame& result);

  PinholeCamera camera_;
  TfFrames frames_;
  ros::Publisher tf_, doubtful_, pose_, pose_with_covariance_, path_, cloud_;
};

}  // namespace kinloop::ros1
