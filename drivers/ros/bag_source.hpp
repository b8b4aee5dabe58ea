#pragma once
// In: a bag with the topics of an RGB-D camera: ROS 1 (.bag), also as recorded by the RealSense SDK, or ROS 2
// (.mcap, .db3 or their folder); all are read without ROS. Out: its frames.

#include <filesystem>
#include <memory>
#include <optional>

#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether the path is a bag, by its name: .bag, .mcap, .db3, or a folder with ROS 2 bag files.
bool is_bag(const std::filesystem::path& path);

/// How a bag is read.
struct BagRequest {
  std::filesystem::path path;
  std::optional<RgbdCamera> camera;    ///< instead of that of the bag
  bool camera_has_depth_scale = true;  ///< else the unit of depth is that of the bag
  std::optional<double> depth_scale;   ///< units per metre of 16-bit depth, instead of both
  std::optional<std::string> topics;   ///< "COLOR,DEPTH[,CAMERA_INFO]"
};

/// Opens a bag on the topics of iai_kinect2 (/kinect2/{qhd,hd,sd}), of the usual drivers (/camera/...), of
/// the RealSense SDK, of `kinloop record`, or on `topics` ("COLOR,DEPTH[,CAMERA_INFO]"). The camera is
/// `camera` if given, else that of the bag; depth that is not registered to colour is registered. 16-bit
/// depth is in units of the `depth_scale` that is given, else of the bag (ROS: millimetres). Images that are
/// damaged, of an unknown encoding, without partner or with decreasing time are skipped and counted. Throws
/// InputError if the file is not a bag, has none of these topics or no calibration.
std::unique_ptr<FrameSource> open_bag(const BagRequest& request);
std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& path,
                                      const std::optional<RgbdCamera>& camera,
                                      const std::optional<std::string>& topics = {});

}  // namespace kinloop
