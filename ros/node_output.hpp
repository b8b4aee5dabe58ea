#pragma once
// In: the result of each frame. Out: TF, pose, its covariance, path and cloud on topics.

#include <string>

#include <ros/node_handle.h>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop::ros1 {

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
