#pragma once
// In: the normals of the surfaces that cameras saw, and the cameras' poses. Out: which way is up, for
// pictures and files; no estimate of the map depends on it.

#include <span>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

enum class UpSource {
  kPlanes,  ///< floors, tables and walls agree on it
  kCamera,  ///< they do not: the mean of the cameras' own up (-y) axes
};

/// "planes" or "camera".
const char* to_string(UpSource source);

/// Which way is up in the world, by default the first camera's own up.
struct UpEstimate {
  Eigen::Vector3d direction = {0, -1, 0};
  UpSource source = UpSource::kCamera;
  /// From planes: the probability of this direction among all that planes offer. From cameras: the length of
  /// the mean of their unit axes, 1 where all agree.
  double confidence = 0;
};

/// Up from surfaces, where they leave no doubt, else from the cameras. `normals` are unit vectors towards the
/// cameras, each of the same area of surface.
///
/// Most surfaces of a place made by people are level or upright. Every direction is rated by the share of
/// surface that would then be either; the best few compete, each with both signs, by what else is known of
/// cameras that people carry: level surfaces are mostly seen from above, cameras look around rather than up
/// or down, and most are held upright. No one of these decides, so a camera may be rolled in any way.
UpEstimate estimate_up_direction(std::span<const Eigen::Vector3f> normals,
                                 std::span<const SE3> T_world_cameras);

/// The mean of the cameras' own up axes.
UpEstimate mean_camera_up(std::span<const SE3> T_world_cameras);

/// The poses alone.
std::vector<SE3> camera_poses(const Trajectory& trajectory);

/// The rotation from the world to a frame with z along `up` in which the camera at `T_world_first` looks
/// along y, as seen from above; where it looks straight up or down, the top of its image points along y.
Eigen::Quaterniond upright_rotation(const Eigen::Vector3d& up, const SE3& T_world_first);

}  // namespace kinloop
