#pragma once
// In: the poses of a camera that someone carried. Out: which way is up, for pictures; no estimate depends on
// it.

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// The direction that is most nearly square to the image rows of all poses, since people hold cameras level
/// but tilt them; (0, 0, 1) for no poses.
Eigen::Vector3d up_direction(const Trajectory& trajectory);

}  // namespace kinloop
