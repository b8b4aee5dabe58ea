#include "drivers/ros/bag_camera.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>

#include "drivers/ros/messages/ros_serialization.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

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

bool same_intrinsics(const RosCameraInfo& a, const RosCameraInfo& b) {
  constexpr double kTolerance_px = 1e-3;
  return a.width == b.width && a.height == b.height &&
         std::equal(a.K.begin(), a.K.end(), b.K.begin(),
                    [](double x, double y) { return std::abs(x - y) < kTolerance_px; });
}

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
  /// Whether depth has the intrinsics of colour: no two cameras have, so depth was registered.
  [[nodiscard]] bool same_camera() const { return color && depth && same_intrinsics(*color, *depth); }
  [[nodiscard]] bool complete() const {
    return color && color_frame && depth_frame &&
           (same_frame() || same_camera() || (depth && T_color_depth()));
  }
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
  const bool registered = streams.topics.states_registered_depth();
  const auto settled = [&] { return registered && found.color && found.color_frame && found.depth_frame; };
  while (!found.complete() && !settled()) {
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

/// Throws InputError for depth of a camera of its own of which the bag does not tell all.
void require_depth_calibration(const Findings& found, const BagStreams& streams, const std::string& name) {
  const std::string frames = fmt::format("depth is in the frame '{}', colour in '{}'",
                                         found.depth_frame.value_or("?"), found.color_frame.value_or("?"));
  if (!found.depth) {
    throw InputError(fmt::format(
        "{}: {}, and no message on topic {} tells the camera of depth; use --camera FILE, with depth and "
        "T_color_depth unless depth is registered to colour",
        name, frames, streams.topics.depth_info()));
  }
  if (!found.T_color_depth()) {
    throw InputError(fmt::format(
        "{}: {}, and /tf_static does not connect them; use --camera FILE with depth and T_color_depth", name,
        frames));
  }
}

}  // namespace

RgbdCamera read_bag_camera(MessageFile& file, const BagStreams& streams, const std::string& name) {
  const Findings found = read_findings(file, streams);
  if (!found.color)
    throw InputError(
        fmt::format("{}: no camera: no message on topic {}; use --camera FILE", name, streams.topics.info));
  RgbdCamera camera;
  camera.color = camera_from(*found.color, streams.topics.rectified());
  if (found.same_frame() || !found.color_frame || !found.depth_frame) return camera;
  const bool stated = streams.topics.states_registered_depth();
  if (stated || found.same_camera()) {
    log::info("{}: depth is taken as registered to colour, {}; its coordinate frame '{}' is not used", name,
              stated ? fmt::format("as its topic {} states", streams.topics.depth)
                     : std::string("since both have the same intrinsics"),
              *found.depth_frame);
    return camera;
  }
  require_depth_calibration(found, streams, name);
  const bool depth_rectified = streams.topics.depth.find("rect") != std::string::npos;
  camera.depth = camera_from(*found.depth, depth_rectified);
  camera.T_color_depth = *found.T_color_depth();
  return camera;
}

}  // namespace kinloop
