#pragma once
// In: the keypoints of two views and the pose between them. Out: whether the depths both measured can be
// those of one scene. Furniture that looks alike makes a pose certain wherever it stands; the room around it
// does not.

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// What two views say of each other's keypoints. Those that the other view hides say nothing: something
/// stands in between.
struct DepthConsistency {
  int consistent = 0;             ///< lie where the other view measured a surface
  int free_space_violations = 0;  ///< lie clearly in front of it: the other view looks through them

  DepthConsistency& operator+=(const DepthConsistency& other);
};

/// Holds the keypoints of each view against the planes that the other one measured around its own, within
/// the noise of both depths and `position_sigma_m` of the pose.
DepthConsistency compare_depths(const Features& a, const Features& b, const SE3& T_a_b,
                                const PinholeCamera& camera, double position_sigma_m);

/// Whether more are seen through than one or two strays and that share of all: a scene of solid things does
/// not allow it.
bool violates_free_space(const DepthConsistency& depths, double max_violation_ratio);

}  // namespace kinloop
