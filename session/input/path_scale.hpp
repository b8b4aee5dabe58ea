#pragma once
// In: the path of the camera, and poses that came with the recording. Out: whether one is a multiple of the
// other. Without such poses nobody can tell: with all depths twice as large, the path and the landmarks are
// twice as large, and so every parallax is the same.

#include <optional>

#include "kinloop/geometry/trajectory.hpp"
#include "session/input/checks/input_warning.hpp"

namespace kinloop {

/// Returns a warning if `estimate` agrees with `truth`, but only at another scale. `depth_scale` is in units
/// per metre, as stated by the camera; nullopt if depth is stored in metres, which no depth_scale changes.
std::optional<InputWarning> check_path_scale(const Trajectory& estimate, const Trajectory& truth,
                                             std::optional<double> depth_scale);

}  // namespace kinloop
