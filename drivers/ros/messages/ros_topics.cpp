#include "drivers/ros/messages/ros_topics.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// The topic as named in the bag, raw or compressed; empty if absent.
std::string present(const std::set<std::string>& in_bag, const std::string& topic, const char* compressed) {
  if (in_bag.contains(topic)) return topic;
  return in_bag.contains(topic + compressed) ? topic + compressed : "";
}

}  // namespace

bool RosTopics::states_registered_depth() const {
  constexpr const char* kParts[] = {"aligned_depth_to_color", "depth_registered", "depth_to_rgb"};
  return std::any_of(std::begin(kParts), std::end(kParts),
                     [this](const char* part) { return depth.find(part) != std::string::npos; });
}

const std::vector<RosTopics>& known_topics() {
  static const std::vector<RosTopics> topics = {
      {"/kinect2/qhd/image_color_rect", "/kinect2/qhd/image_depth_rect", "/kinect2/qhd/camera_info"},
      {"/kinect2/hd/image_color_rect", "/kinect2/hd/image_depth_rect", "/kinect2/hd/camera_info"},
      {"/kinect2/sd/image_color_rect", "/kinect2/sd/image_depth_rect", "/kinect2/sd/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image_raw", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image", "/camera/rgb/camera_info"},
      {"/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw", "/camera/color/camera_info"},
      {"/camera/camera/color/image_raw", "/camera/camera/aligned_depth_to_color/image_raw",
       "/camera/camera/color/camera_info"},  // realsense2_camera of ROS 2
      {"/camera/rgb/image_raw", "/camera/depth_registered/image_raw", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_color", "/camera/depth/image", "/camera/rgb/camera_info"},  // bags of TUM RGB-D
      {"/rgb/image_raw", "/depth_to_rgb/image_raw", "/rgb/camera_info"},              // Azure Kinect
      {"/zed/zed_node/rgb/image_rect_color", "/zed/zed_node/depth/depth_registered",
       "/zed/zed_node/rgb/camera_info"},
      {"/oak/rgb/image_raw", "/oak/stereo/image_raw", "/oak/rgb/camera_info"},
  };
  return topics;
}

const std::vector<RosTopics>& known_unregistered_topics() {
  static const std::vector<RosTopics> topics = {
      {"/camera/color/image_raw", "/camera/depth/image_rect_raw", "/camera/color/camera_info"},
      {"/camera/camera/color/image_raw", "/camera/camera/depth/image_rect_raw",
       "/camera/camera/color/camera_info"},
      {"/camera/color/image_raw", "/camera/depth/image_raw", "/camera/color/camera_info"},  // Orbbec
      {"/camera/rgb/image_raw", "/camera/depth/image_raw", "/camera/rgb/camera_info"},
      {"/rgb/image_raw", "/depth/image_raw", "/rgb/camera_info"},
  };
  return topics;
}

BagStreams choose_streams(const std::set<std::string>& in_bag, const std::optional<std::string>& wanted,
                          const std::string& name) {
  std::vector<RosTopics> candidates = known_topics();
  candidates.insert(candidates.end(), known_unregistered_topics().begin(), known_unregistered_topics().end());
  if (wanted) candidates = {parse_topics(*wanted)};
  for (const RosTopics& candidate : candidates) {
    BagStreams streams{candidate, present(in_bag, candidate.color, "/compressed"),
                       present(in_bag, candidate.depth, "/compressedDepth")};
    if (!streams.color.empty() && !streams.depth.empty()) return streams;
  }
  throw InputError(
      fmt::format("{}: no topics of a known RGB-D camera; use --topics COLOR,DEPTH[,CAMERA_INFO] "
                  "with two of: {}",
                  name, in_bag.empty() ? "(none)" : fmt::format("{}", fmt::join(in_bag, ", "))));
}

RosTopics parse_topics(std::string_view text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  bool usable = parts.size() == 2 || parts.size() == 3;
  for (const auto& part : parts) usable = usable && part.size() > 1 && part.front() == '/';
  if (!usable) {
    throw UsageError(fmt::format("--topics: '{}' is not COLOR,DEPTH[,CAMERA_INFO], e.g. {},{}", text,
                                 known_topics()[0].color, known_topics()[0].depth));
  }
  const std::string& color = parts[0];
  return {color, parts[1], parts.size() == 3 ? parts[2] : color.substr(0, color.rfind('/')) + "/camera_info"};
}

}  // namespace kinloop
