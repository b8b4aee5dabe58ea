#pragma once
// Drift: how far the relative pose of two keyframes may be off the pose that the map predicts, given the
// distance travelled between them since they were last joined by a loop closure. The bounds are generous:
// they must never exclude a true loop.

#include <optional>
#include <vector>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// Largest plausible error of a predicted relative pose.
struct DriftBound {
  double translation_m = 0;
  double rotation_rad = 0;
};

/// A relative pose predicted by the map.
struct PredictedView {
  SE3 T_reference_camera;
  DriftBound bound;
};

/// Returns for each keyframe the length of the shortest path to it from `keyframe`, along successive
/// keyframes and loop closures, m. A turn counts as one metre per radian, since rotation drifts too. Infinity
/// without a path.
std::vector<double> travelled_distances(const Map& map, KeyframeId keyframe);

/// Returns the drift bound after travelling `distance_m`.
DriftBound drift_bound(double distance_m);

/// Returns the largest angle by which drift may displace the direction of a point at `p_camera`, rad.
double direction_bound_rad(const DriftBound& bound, const Eigen::Vector3d& p_camera);

/// Returns the predicted pose of `camera` relative to `reference`; nullopt if `travelled_m`, the distance
/// between them, is infinite.
std::optional<PredictedView> predict_view(const Map& map, KeyframeId reference, KeyframeId camera,
                                          double travelled_m);

/// Returns whether drift explains the difference between a predicted and a measured pose.
bool is_explained_by_drift(const PredictedView& predicted, const SE3& T_reference_camera);

/// Returns whether at least `min_keypoints` keypoints of `reference` with depth could appear in the camera's
/// view.
bool may_overlap(const Features& reference, const PredictedView& predicted, const PinholeCamera& camera,
                 int min_keypoints);

}  // namespace kinloop
