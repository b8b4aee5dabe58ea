#pragma once
// The field of view of a lens, beyond which its distortion cannot be undone.

#include <optional>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Returns the undistorted pixel of a raw one; nullopt if that is outside the lens's field of view:
/// distorting the result would not lead back to `raw`.
std::optional<Eigen::Vector2d> undistort_in_view(const PinholeCamera& camera, const Eigen::Vector2d& raw);

}  // namespace kinloop
