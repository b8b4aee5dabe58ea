#pragma once
// Tracks a prepared frame against the previous frame and the local map, starting from a predicted pose.
// Returns the pose relative to the reference keyframe and the landmark matches. A pure function: the caller
// keeps all state.

#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/tracking/frame.hpp"
#include "kinloop/tracking/motion_model.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

enum class TrackStatus {
  kTracked,    ///< by landmarks of the map, or by points of the previous frame
  kDenseOnly,  ///< by dense alignment, since there were too few features
  kLost,
};

/// Keypoint `feature` of the frame observes `landmark`.
struct LandmarkMatch {
  LandmarkId landmark;
  uint32_t feature = 0;
};

struct TrackStats {
  int previous_frame_inliers = 0;  ///< inliers of the pose relative to the previous frame
  int visible_landmarks = 0;       ///< landmarks of the local map in view
  int inliers = 0;                 ///< landmarks matched consistently with the pose
  int attempts = 0;  ///< number of methods tried against the previous frame (1 = the first succeeded)
};

struct TrackResult {
  TrackStatus status = TrackStatus::kLost;
  KeyframeId reference;
  SE3 T_reference_camera;
  Matrix6d information = Matrix6d::Zero();  ///< of a right perturbation (translation; rotation)
  std::vector<LandmarkMatch> matches;
  TrackStats stats;
};

/// Tracks `frame` against `previous` and `local_map`, starting from the predicted T_reference_camera. `seed`
/// drives RANSAC.
TrackResult track(const PreparedFrame& frame, const TrackedFrame& previous, const LocalMap& local_map,
                  const PredictedPose& predicted, const PinholeCamera& camera, const TrackingOptions& options,
                  uint64_t seed);

/// Returns whether enough of the visible landmarks were matched (their number is limited by the frame's
/// keypoints). Chance matches can agree on a wrong pose, but then few landmarks are found at their
/// projections.
bool has_sufficient_inlier_ratio(const TrackResult& result, const Features& features,
                                 double min_inlier_ratio);

/// Matches the landmarks of `local_map` with keypoints of `frame` near their projections under
/// `T_reference_camera_guess`, and refines the pose on them. `window_px` is the half side of the search
/// windows. Used by `track` and for place recognition.
TrackResult track_local_map(const PreparedFrame& frame, const FeatureGrid& grid, const LocalMap& local_map,
                            const SE3& T_reference_camera_guess, double window_px,
                            const PinholeCamera& camera, const TrackingOptions& options);

}  // namespace kinloop
