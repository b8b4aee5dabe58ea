#pragma once
// Depth check: tests whether the depth measurements of two views are consistent with one scene, given their
// relative pose. Similar furniture can give a confident pose in the wrong place, but then the geometry around
// it differs.

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Consistency of two views with each other's keypoints. Keypoints occluded in the other view do not count.
struct DepthConsistency {
  int consistent = 0;             ///< lie on a surface measured by the other view
  int free_space_violations = 0;  ///< lie clearly in front of it, in free space of the other view

  DepthConsistency& operator+=(const DepthConsistency& other);
};

/// Compares the keypoints of each view with the planes measured around the keypoints of the other, within the
/// noise of depth and the standard deviation of the relative position.
DepthConsistency compare_depths(const Features& a, const Features& b, const SE3& T_a_b, const Sensor& sensor,
                                double position_sigma_m);

/// Returns whether free-space violations exceed one or two outliers and the given ratio of all keypoints,
/// which is impossible in a scene of solid objects.
bool violates_free_space(const DepthConsistency& depths, double max_violation_ratio);

}  // namespace kinloop
