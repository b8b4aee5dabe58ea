#pragma once
// In: the keypoints of two views and the pose between them. Out: whether one of them shows something that
// the other one ought to show as well, and does not. An armchair before a wall looks the same in two rooms;
// the pictures on the wall do not.

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// The chance that views of one scene differ as much: of the hundred keypoints side by side of which fewest
/// are found in the other view, each found with a third of the probability that all others are. 1 where there
/// is too little to tell. Keypoints that the other view hides do not count.
double appearance_p_value(const Features& a, const Features& b, const SE3& T_a_b,
                          const PinholeCamera& camera);

}  // namespace kinloop
