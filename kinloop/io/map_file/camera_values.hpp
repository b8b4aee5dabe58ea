#pragma once
// A camera as the named values of a map file.

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Returns the values that describe the camera, in the order of the file.
std::vector<std::pair<std::string, double>> camera_values(const RgbdCamera& camera);

/// Inverse of `camera_values`; nullopt if a value is missing or impossible.
std::optional<RgbdCamera> camera_from(const std::map<std::string, double>& values);

}  // namespace kinloop
