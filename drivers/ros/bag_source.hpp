#pragma once
// In: a ROS bag with the topics of an RGB-D camera. Out: its frames, without a ROS master, via
// librosbag-storage (optional dependency).

#include <filesystem>
#include <memory>
#include <optional>

#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// Returns whether this build reads bags.
bool bags_available();

/// Opens a bag on the topics of iai_kinect2 (/kinect2/{qhd,hd,sd}), of the usual drivers (/camera/...) or on
/// `topics` ("COLOR,DEPTH[,CAMERA_INFO]"). The camera is `camera` if given, else that of camera_info. Images
/// with an unknown encoding, without partner or with decreasing time are skipped and counted. Throws
/// InputError if the file is not a bag, is truncated or has none of these topics, and UsageError in a build
/// without ROS.
std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& path,
                                      const std::optional<RgbdCamera>& camera,
                                      const std::optional<std::string>& topics = {});

}  // namespace kinloop
