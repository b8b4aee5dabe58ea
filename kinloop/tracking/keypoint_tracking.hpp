#pragma once
// Tracks a frame by its keypoints against the previous frame and the local map, starting from a predicted
// pose. Pure functions: the caller keeps all state.

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/map/tracked_frame.hpp"
#include "kinloop/tracking/motion_model.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// What a frame is tracked against, and how.
struct TrackingTarget {
  const LocalMap& local_map;
  const PinholeCamera& camera;
  const TrackingOptions& options;
};

/// Tracks `frame` against `previous` (whose pose is relative to the reference of the local map) and the local
/// map, starting from the predicted T_reference_camera. `seed` drives RANSAC. The result is lost if too few
/// landmarks agree.
TrackedFrame track_keypoints(const Frame& frame, const TrackedFrame& previous, const PredictedPose& predicted,
                             const TrackingTarget& target, uint64_t seed);

/// Returns whether enough of the visible landmarks were matched (their number is limited by the frame's
/// keypoints). Chance matches can agree on a wrong pose, but then few landmarks are found at their
/// projections.
bool has_sufficient_inlier_ratio(const TrackedFrame& tracked, const Features& features,
                                 double min_inlier_ratio);

/// Matches the landmarks of the local map with keypoints of `frame` near their projections under
/// `T_reference_camera_guess`, and refines the pose on them. `window_px` is the half side of the search
/// windows. Used by `track_keypoints` and for place recognition.
TrackedFrame track_local_map(const Frame& frame, const FeatureGrid& grid, const SE3& T_reference_camera_guess,
                             double window_px, const TrackingTarget& target);

}  // namespace kinloop
