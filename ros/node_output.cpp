#include <algorithm>
#include <cstring>

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Bool.h>
#include <tf2_msgs/TFMessage.h>

#include "drivers/ros/messages/ros_messages.hpp"
#include "kinloop/map/frames/pose_covariance.hpp"
#include "ros/node.hpp"

namespace kinloop::ros1 {
namespace {

using PoseStamped = geometry_msgs::PoseStamped_<Allocator<void>>;
using PoseWithCovarianceStamped = geometry_msgs::PoseWithCovarianceStamped_<Allocator<void>>;
using TransformStamped = geometry_msgs::TransformStamped_<Allocator<void>>;
using TFMessage = tf2_msgs::TFMessage_<Allocator<void>>;
using Path = nav_msgs::Path_<Allocator<void>>;
using PointCloud2 = sensor_msgs::PointCloud2_<Allocator<void>>;
using PointField = sensor_msgs::PointField_<Allocator<void>>;
using Quaternion = geometry_msgs::Quaternion_<Allocator<void>>;
using Bool = std_msgs::Bool_<Allocator<void>>;
using Header = std_msgs::Header_<Allocator<void>>;

Header header_of(int64_t stamp_ns, const std::string& frame) {
  Header header;
  header.stamp.fromNSec(static_cast<uint64_t>(stamp_ns));
  header.frame_id = frame.c_str();
  return header;
}

Quaternion quaternion_of(const Eigen::Quaterniond& rotation) {
  Quaternion quaternion;
  quaternion.x = rotation.x();
  quaternion.y = rotation.y();
  quaternion.z = rotation.z();
  quaternion.w = rotation.w();
  return quaternion;
}

PoseStamped pose_of(int64_t stamp_ns, const SE3& T, const std::string& frame) {
  PoseStamped pose;
  pose.header = header_of(stamp_ns, frame);
  pose.pose.position.x = T.translation.x();
  pose.pose.position.y = T.translation.y();
  pose.pose.position.z = T.translation.z();
  pose.pose.orientation = quaternion_of(T.rotation);
  return pose;
}

TransformStamped transform_of(const Header& parent, const std::string& child, const SE3& T_parent_child) {
  TransformStamped transform;
  transform.header = parent;
  transform.child_frame_id = child.c_str();
  transform.transform.translation.x = T_parent_child.translation.x();
  transform.transform.translation.y = T_parent_child.translation.y();
  transform.transform.translation.z = T_parent_child.translation.z();
  transform.transform.rotation = quaternion_of(T_parent_child.rotation);
  return transform;
}

/// The same pose with its covariance: of x, y, z and the rotations about the fixed axes, row by row (REP
/// 103).
PoseWithCovarianceStamped with_covariance(const PoseStamped& pose, const Matrix6d& in_world_axes) {
  PoseWithCovarianceStamped message;
  message.header = pose.header;
  message.pose.pose = pose.pose;
  // It is symmetric, so the order of storage does not matter.
  std::copy_n(in_world_axes.data(), in_world_axes.size(), message.pose.covariance.begin());
  return message;
}

/// A point of a PointCloud2 with colour.
struct CloudPoint {
  float x, y, z;
  uint8_t b, g, r, unused;
};

PointCloud2 empty_cloud(const Header& header) {
  PointCloud2 cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.is_dense = 1U;
  cloud.point_step = sizeof(CloudPoint);
  const char* names[] = {"x", "y", "z", "rgb"};
  for (uint32_t i = 0; i < 4; ++i) {
    PointField field;
    field.name = names[i];
    field.offset = 4 * i;
    field.datatype = PointField::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  return cloud;
}

}  // namespace

NodeOutput::NodeOutput(ros::NodeHandle node, const PinholeCamera& camera, TfFrames frames)
    : camera_(camera), frames_(std::move(frames)) {
  constexpr uint32_t kMaxUnsent = 10;
  tf_ = node.advertise<TFMessage>("/tf", kMaxUnsent);
  doubtful_ = node.advertise<Bool>("doubtful", kMaxUnsent);
  pose_ = node.advertise<PoseStamped>("pose", kMaxUnsent);
  pose_with_covariance_ = node.advertise<PoseWithCovarianceStamped>("pose_with_covariance", kMaxUnsent);
  path_ = node.advertise<Path>("path", 1, true);
  cloud_ = node.advertise<PointCloud2>("cloud", kMaxUnsent);
}

void NodeOutput::publish_pose(const TrackedFrame& result) {
  Bool doubtful;
  doubtful.data = result.is_doubtful() ? 1U : 0U;
  doubtful_.publish(doubtful);
  const PoseStamped pose = pose_of(result.stamp_ns, result.T_world_camera, frames_.world);
  pose_.publish(pose);
  // A doubtful pose may be wrong by more than its covariance, and filters take zeros for certainty.
  if (const auto covariance = pose_covariance(result); covariance && !result.is_doubtful()) {
    const Matrix6d in_world_axes = covariance_in_world_axes(*covariance, result.T_world_camera);
    pose_with_covariance_.publish(with_covariance(pose, in_world_axes));
  }
  publish_transforms(result);
}

void NodeOutput::publish_transforms(const TrackedFrame& result) {
  const auto& [world, odometry, camera] = frames_;
  TFMessage message;
  const auto add = [&](const std::string& parent, const std::string& child, const SE3& T_parent_child) {
    message.transforms.push_back(transform_of(header_of(result.stamp_ns, parent), child, T_parent_child));
  };
  if (odometry.empty()) {
    add(world, camera, result.T_world_camera);
  } else {
    add(world, odometry, result.T_map_odom);
    add(odometry, camera, result.T_map_odom.inverse() * result.T_world_camera);
  }
  tf_.publish(message);
}

void NodeOutput::publish_path(const Trajectory& trajectory) {
  if (trajectory.empty()) return;
  Path path;
  path.header = header_of(trajectory.back().stamp_ns, frames_.world);
  for (const auto& pose : trajectory)
    path.poses.push_back(pose_of(pose.stamp_ns, pose.T_world_camera, frames_.world));
  path_.publish(path);
}

void NodeOutput::publish_cloud(const TrackedFrame& result) {
  constexpr int kStep = 4;  // px: some 20,000 points of a 640 x 480 image
  if (cloud_.getNumSubscribers() == 0) return;
  const Frame& frame = *result.frame;
  const cv::Mat color = frame.color.bgr();
  PointCloud2 cloud = empty_cloud(header_of(result.stamp_ns, frames_.world));
  for (int y = 0; y < frame.depth_m.rows; y += kStep) {
    for (int x = 0; x < frame.depth_m.cols; x += kStep) {
      const auto depth_m = static_cast<double>(frame.depth_m.at<float>(y, x));
      if (!(depth_m > 0)) continue;
      const Eigen::Vector3d p_camera = camera_.unproject(camera_.undistort(Eigen::Vector2d(x, y)), depth_m);
      const Eigen::Vector3f p = (result.T_world_camera * p_camera).cast<float>();
      const auto& bgr = color.at<cv::Vec3b>(y, x);
      const CloudPoint point{p.x(), p.y(), p.z(), bgr[0], bgr[1], bgr[2], 0};
      const size_t end = cloud.data.size();
      cloud.data.resize(end + sizeof point);
      std::memcpy(cloud.data.data() + end, &point, sizeof point);
    }
  }
  cloud.width = static_cast<uint32_t>(cloud.data.size() / sizeof(CloudPoint));
  cloud.row_step = cloud.width * cloud.point_step;
  cloud_.publish(cloud);
}

}  // namespace kinloop::ros1
