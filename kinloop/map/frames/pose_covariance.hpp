#pragma once
// In: the covariance of a pose, of x = (translation; rotation) in the axes of the camera, where the true pose
// is T * exp(x), in metres and radians. Out: the same in the forms of files and messages.

#include <array>
#include <optional>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"

namespace kinloop {

/// Returns the covariance of the frame's pose; nullopt if there is no pose or it is unknown.
std::optional<Matrix6d> pose_covariance(const EstimatedFrame& tracked);

/// Returns the upper triangle, row by row.
std::array<double, 21> upper_triangle(const Matrix6d& symmetric);

/// Returns the covariance in the axes of the world: of (translation; rotation) about its fixed axes, as in
/// geometry_msgs/PoseWithCovariance. `T_world_camera` is the pose.
Matrix6d covariance_in_world_axes(const Matrix6d& covariance, const SE3& T_world_camera);

}  // namespace kinloop
