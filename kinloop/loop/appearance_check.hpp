#pragma once
// Appearance check: tests whether one view lacks something that it should show, given the keypoints of two
// views and their relative pose. An armchair in front of a wall looks the same in two rooms; the pictures on
// the wall do not.

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Returns the p-value of the difference between views of the same scene: among all regions of a hundred
/// neighbouring keypoints, the one of which fewest are found in the other view, if each is found with a third
/// of the overall probability. 1 if there are too few keypoints to decide. Keypoints occluded in the other
/// view do not count.
double appearance_p_value(const Features& a, const Features& b, const SE3& T_a_b,
                          const PinholeCamera& camera);

}  // namespace kinloop
