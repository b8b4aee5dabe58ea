#pragma once
// Published calibrations of standard datasets.

#include <optional>
#include <string_view>

#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Returns the camera called `name`: freiburg1, freiburg2, freiburg3 (TUM RGB-D) or icl (ICL-NUIM); nullopt
/// for any other name.
std::optional<RgbdCamera> camera_preset(std::string_view name);

}  // namespace kinloop
