#include "drivers/ros/bag_camera.hpp"

#include <cmath>
#include <deque>

#include <fmt/format.h>

#include "drivers/ros/ros_serialization.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

namespace {

/// tf of ROS 1 wrote "/frame", later versions write "frame".
std::string without_slash(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

}  // namespace

void FrameTree::add(const StampedTransform& transform) {
  const std::string parent = without_slash(transform.header.frame_id), child = without_slash(transform.child);
  T_parent_child_[parent].emplace(child, transform.T_parent_child);
  T_parent_child_[child].emplace(parent, transform.T_parent_child.inverse());
}

std::optional<SE3> FrameTree::between(const std::string& a, const std::string& b) const {
  const std::string start = without_slash(a), goal = without_slash(b);
  std::map<std::string, SE3> T_start = {{start, SE3()}};  // to each frame reached
  std::deque<std::string> open = {start};
  while (!open.empty() && !T_start.contains(goal)) {
    const std::string frame = open.front();
    open.pop_front();
    const auto neighbours = T_parent_child_.find(frame);
    if (neighbours == T_parent_child_.end()) continue;
    for (const auto& [next, T_frame_next] : neighbours->second) {
      if (T_start.emplace(next, T_start.at(frame) * T_frame_next).second) open.push_back(next);
    }
  }
  const auto found = T_start.find(goal);
  return found == T_start.end() ? std::nullopt : std::optional(found->second);
}

namespace {

/// What has been read of the calibration so far.
struct Findings {
  std::optional<std::string> color_frame, depth_frame;
  std::optional<RosCameraInfo> color, depth;
  FrameTree frames;

  [[nodiscard]] bool same_frame() const { return color_frame && depth_frame && *color_frame == *depth_frame; }
  [[nodiscard]] std::optional<SE3> T_color_depth() const {
    if (!color_frame || !depth_frame) return std::nullopt;
    return frames.between(*color_frame, *depth_frame);
  }
  [[nodiscard]] bool complete() const { return color && (same_frame() || (depth && T_color_depth())); }
};

/// The frame of an image; both kinds of message begin with the header.
std::string frame_of(const BagMessage& message) {
  return RosReader(message.data, message.topic->encoding).header().frame_id;
}

void look_at(const BagMessage& message, const BagStreams& streams, Findings& found) {
  const std::string& topic = message.topic->name;
  const auto reader = [&] { return RosReader(message.data, message.topic->encoding); };
  if (topic == streams.color && !found.color_frame) found.color_frame = frame_of(message);
  if (topic == streams.depth && !found.depth_frame) found.depth_frame = frame_of(message);
  if (topic == streams.topics.info && !found.color) found.color = read_camera_info(reader()).info;
  if (topic == streams.topics.depth_info() && !found.depth) found.depth = read_camera_info(reader()).info;
  if (message.topic->type != "tf2_msgs/TFMessage" && message.topic->type != "tf/tfMessage") return;
  for (const StampedTransform& transform : read_transforms(reader())) found.frames.add(transform);
}

Findings read_findings(MessageFile& file, const BagStreams& streams) {
  Findings found;
  file.select(
      {streams.color, streams.depth, streams.topics.info, streams.topics.depth_info(), "/tf_static", "/tf"});
  while (!found.complete()) {
    const auto message = file.next();
    if (!message) break;
    try {
      look_at(*message, streams, found);
    } catch (const InputError&) {
      continue;  // a later message may be intact
    }
  }
  return found;
}

bool same_lens(const PinholeCamera& a, const PinholeCamera& b) {
  constexpr double kTolerancePx = 1e-3;
  return a.width == b.width && a.height == b.height && std::abs(a.fx - b.fx) < kTolerancePx &&
         std::abs(a.cx - b.cx) < kTolerancePx;
}

/// Whether depth needs no registration for this transform.
bool is_identity(const SE3& T) {
  constexpr double kToleranceM = 1e-6, kToleranceRad = 1e-6;
  return T.translation.norm() < kToleranceM && T.angle_rad() < kToleranceRad;
}

}  // namespace

RgbdCamera read_bag_camera(MessageFile& file, const BagStreams& streams, const std::string& name) {
  const Findings found = read_findings(file, streams);
  if (!found.color)
    throw InputError(
        fmt::format("{}: no camera: no message on topic {}; use --camera FILE", name, streams.topics.info));
  RgbdCamera camera;
  camera.color = camera_from(*found.color, streams.topics.rectified());
  if (found.same_frame() || !found.depth) return camera;
  const bool depth_rectified = streams.topics.depth.find("rect") != std::string::npos;
  const PinholeCamera depth = camera_from(*found.depth, depth_rectified);
  const auto T_color_depth = found.T_color_depth();
  if (same_lens(camera.color, depth) && (!T_color_depth || is_identity(*T_color_depth))) return camera;
  if (!T_color_depth) {
    throw InputError(fmt::format(
        "{}: depth is in the frame '{}', colour in '{}', and /tf_static does not connect them; use --camera "
        "FILE with depth and T_color_depth",
        name, found.depth_frame.value_or("?"), found.color_frame.value_or("?")));
  }
  camera.depth = depth;
  camera.T_color_depth = *T_color_depth;
  return camera;
}

}  // namespace kinloop
