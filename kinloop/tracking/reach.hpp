#pragma once
// Where a camera can have got since its last pose beyond doubt.

#include "kinloop/geometry/velocity.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// A pose beyond doubt.
struct TrustedPose {
  KeyframeId reference;
  SE3 T_reference_camera;
  Velocity velocity;
  int64_t stamp_ns = 0;
};

/// Returns whether the camera can be at `p_world` (m, in the world of the reference's component) at a later
/// time: by going on, and changing the velocity no faster than a person does for long. The pose may have
/// drifted since that part of the map was made.
bool can_reach(const TrustedPose& from, const Map& map, const Eigen::Vector3d& p_world, int64_t stamp_ns);

}  // namespace kinloop
