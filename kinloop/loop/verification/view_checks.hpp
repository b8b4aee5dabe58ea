#pragma once
// Checks whether two views can show one scene, given their keypoints and their relative pose.
//
// Depth: similar furniture can give a confident pose in the wrong place, but then the geometry around it
// differs, and one view sees through what the other measured.
// Appearance: an armchair in front of a wall looks the same in two rooms; the pictures on the wall do not.

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/map/loop_closure.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// Consistency of two views with each other's keypoints. Keypoints occluded in the other view do not count.
struct DepthConsistency {
  int consistent = 0;             ///< lie on a surface measured by the other view
  int free_space_violations = 0;  ///< lie clearly in front of it, in free space of the other view

  DepthConsistency& operator+=(const DepthConsistency& other);
};

/// What a view shows.
struct View {
  const Features& features;
  const SurfaceGrid* surfaces = nullptr;  ///< of what is at rest; null if they are not known
};

/// Compares the keypoints at rest of each view with the planes measured around the keypoints of the other,
/// within the noise of depth and the standard deviation of the relative position.
DepthConsistency compare_depths(const View& a, const View& b, const SE3& T_a_b, const Sensor& sensor,
                                double position_sigma_m);

/// Returns whether free-space violations exceed one or two outliers and the given ratio of all keypoints,
/// which is impossible in a scene of solid objects.
bool contradicts_free_space(const DepthConsistency& depths, double max_violation_ratio);

/// Returns whether a point of a view is on a surface at rest; true if the surfaces are not known.
bool is_at_rest(const Eigen::Vector3d& p_view, const View& view);

/// Returns the p-value of the difference between views of the same scene: among all regions of a hundred
/// neighbouring keypoints, the one of which fewest are found in the other view, if each is found with a third
/// of the overall probability. 1 if there are too few keypoints to decide. Keypoints occluded in the other
/// view do not count, nor those that are not on surfaces at rest of both views, where these are known.
double appearance_p_value(const View& a, const View& b, const SE3& T_a_b, const PinholeCamera& camera);

/// What two views that should show the same say of each other.
struct ViewComparison {
  double appearance_p_value = 1;
  RelativeScale scale = {};
};

/// Counts views that have been compared.
struct AppearanceTally {
  int views = 0;
  int different_views = 0;  ///< by appearance, or by the size of what both show

  void add(const ViewComparison& comparison);

  /// Returns whether too many views are different for the same place, if there are enough to tell.
  [[nodiscard]] bool contradicts_same_place() const;
};

}  // namespace kinloop
