#pragma once
// The topics of RGB-D cameras, by driver.

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace kinloop {

/// Topics of colour, registered depth and camera calibration.
struct RosTopics {
  std::string color, depth, info;

  /// Returns whether the images are rectified (undistorted), judged by topic name as is usual in ROS.
  [[nodiscard]] bool rectified() const { return color.find("rect") != std::string::npos; }

  /// Returns whether depth is registered to colour, as drivers state by the name of the topic.
  [[nodiscard]] bool states_registered_depth() const;

  /// Returns the topic of the depth camera's calibration.
  [[nodiscard]] std::string depth_info() const { return depth.substr(0, depth.rfind('/')) + "/camera_info"; }
};

/// Returns the known topics of colour and registered depth in the order in which they are tried.
const std::vector<RosTopics>& known_topics();

/// Returns the known topics of depth that may be from a camera of its own.
const std::vector<RosTopics>& known_unregistered_topics();

/// Parses "COLOR,DEPTH[,CAMERA_INFO]"; CAMERA_INFO defaults to the one next to the colour topic. Throws
/// UsageError for anything else.
RosTopics parse_topics(std::string_view text);

/// The topics of a bag that are read.
struct BagStreams {
  RosTopics topics;          ///< of raw images
  std::string color, depth;  ///< as in the bag, raw or compressed
};

/// Returns the first known topics, or `wanted`, that the bag `name` has, raw or compressed. Throws InputError
/// listing the image topics if there are none.
BagStreams choose_streams(const std::set<std::string>& in_bag, const std::optional<std::string>& wanted,
                          const std::string& name);

}  // namespace kinloop
