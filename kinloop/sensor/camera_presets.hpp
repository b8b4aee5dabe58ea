#pragma once
// The published cameras of the standard data sets.

#include <optional>
#include <string_view>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// The camera called `name`: freiburg1, freiburg2, freiburg3 (TUM RGB-D) or icl (ICL-NUIM); nothing for any
/// other name.
std::optional<RgbdCamera> camera_preset(std::string_view name);

}  // namespace kinloop
