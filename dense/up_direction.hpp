#pragma once
// In: surface normals and camera poses. Out: the up direction, for display and export; no estimate of the map
// depends on it.

#include <span>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

enum class UpSource {
  kPlanes,  ///< floors, tables and walls agree on it
  kCamera,  ///< mean of the cameras' up (-y) axes, if the surfaces do not agree
  kGiven,   ///< by the user
};

/// Returns "planes", "camera" or "given".
const char* to_string(UpSource source);

/// The up direction in the world frame; by default that of the first camera.
struct UpEstimate {
  Eigen::Vector3d direction = {0, -1, 0};
  UpSource source = UpSource::kCamera;
  /// From planes: the probability of this direction among all candidates. From cameras: the length of the
  /// mean of their unit axes, 1 if all agree, and no more than what surfaces say for a direction near it.
  double confidence = 0;
};

/// Estimates the up direction from surfaces if they are unambiguous, else from the cameras. `normals` are
/// unit vectors towards the cameras, each representing the same surface area.
/// Most surfaces in man-made places are horizontal or vertical. Every direction is scored by the share of
/// surface that would then be either; the best few compete, each with both signs, on what else is known of
/// hand-held cameras: horizontal surfaces are mostly seen from above, cameras pan rather than pitch, and most
/// are held without roll. No single cue decides, so a camera may be rolled by any angle.
UpEstimate estimate_up_direction(std::span<const Eigen::Vector3f> normals,
                                 std::span<const SE3> T_world_cameras);

/// Returns the mean of the cameras' up axes.
UpEstimate mean_camera_up(std::span<const SE3> T_world_cameras);

/// Returns the poses without their stamps.
std::vector<SE3> camera_poses(const Trajectory& trajectory);

/// Returns the rotation from the world to a frame with z along `up` in which the camera at `T_world_first`
/// looks along y, as seen from above; if it looks straight up or down, the top of its image points along y.
Eigen::Quaterniond upright_rotation(const Eigen::Vector3d& up, const SE3& T_world_first);

}  // namespace kinloop
