#pragma once
// Where a camera can have moved since it was seen last.

#include "kinloop/geometry/velocity.hpp"
#include "kinloop/map/keyframe_pose.hpp"

namespace kinloop {

/// Where a camera was, and how it moved, at a time.
struct CameraMotion {
  KeyframePose pose;
  Velocity velocity;
  int64_t stamp_ns = 0;
};

/// Returns whether the camera can be at `p_world` (m, in the world of the reference's component) at a later
/// time: it stops on its way, or changes its velocity no faster than a person does for long. `drift_m` is how
/// far the map may be off there, relative to the pose, beyond half a metre.
bool can_reach(const CameraMotion& from, const Map& map, const Eigen::Vector3d& p_world, int64_t stamp_ns,
               double drift_m = 0);

}  // namespace kinloop
