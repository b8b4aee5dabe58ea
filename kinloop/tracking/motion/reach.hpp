#pragma once
// Where a camera can have moved since its last trusted pose.

#include "kinloop/geometry/velocity.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// A pose that was beyond doubt when it was tracked.
struct TrustedPose {
  KeyframeId reference;
  SE3 T_reference_camera;
  Velocity velocity;
  int64_t stamp_ns = 0;
};

/// Returns whether the camera can be at `p_world` (m, in the world of the reference's component) at a later
/// time: it stops on its way, or changes its velocity no faster than a person does for long. `drift_m` is how
/// far the map may be off there, relative to the pose, beyond half a metre.
bool can_reach(const TrustedPose& from, const Map& map, const Eigen::Vector3d& p_world, int64_t stamp_ns,
               double drift_m = 0);

}  // namespace kinloop
