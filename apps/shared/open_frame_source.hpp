#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/features/options.hpp"
#include "kinloop/place/vocabulary.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {

/// What the user named, and how.
struct SourceRequest {
  std::string sequence;               ///< a folder in TUM layout, sim:room, kinect1, kinect2 or a .bag file
  std::optional<std::string> camera;  ///< camera.yaml or a preset
  std::optional<std::string> topics;  ///< of a bag, "COLOR,DEPTH[,CAMERA_INFO]"
  SimulationOptions simulation;
  KinectOptions kinect;
  Kinect2Frames kinect2_frames = Kinect2Frames::kRegistered;
  int threads = 1;
};

/// Whether frames come at their own pace.
bool is_live(const std::string& sequence);

/// Opens it. Throws UsageError or InputError with the remedy.
std::unique_ptr<FrameSource> open_frame_source(const SourceRequest& request);

/// The vocabulary in `file`, or where that is empty the one built in. Throws UsageError where that does not
/// go with the features.
Vocabulary open_vocabulary(const std::string& file, const FeatureOptions& features);

}  // namespace kinloop
