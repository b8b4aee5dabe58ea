#pragma once
// Tracks a prepared frame against the previous frame and the local map, starting from a predicted pose.
// Returns the pose relative to the reference keyframe and the landmark matches. A pure function: the caller
// keeps all state.

#include <vector>

#include "kinloop/features/matcher.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/sensor/sensor.hpp"
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

/// A frame and what it is tracked with. The frame is motion-compensated.
struct TrackingInput {
  const PreparedFrame& frame;
  const LocalMap& local_map;
  const Sensor& sensor;
  const TrackingOptions& options;
  FeatureGrid grid{*frame.features, sensor.camera.width, sensor.camera.height};
};

/// Tracks a frame against `previous` and the local map, starting from the predicted T_reference_camera.
/// `seed` drives RANSAC.
TrackResult track(const TrackingInput& in, const TrackedFrame& previous, const PredictedPose& predicted,
                  uint64_t seed);

/// Returns whether enough of the visible landmarks were matched (their number is limited by the frame's
/// keypoints). Chance matches can agree on a wrong pose, but then few landmarks are found at their
/// projections.
bool has_sufficient_inlier_ratio(const TrackResult& result, const Features& features,
                                 double min_inlier_ratio);

/// Matches the landmarks of the local map with keypoints of the frame near their projections under
/// `T_reference_camera_guess`, and refines the pose on them. `window_px` is the half side of the search
/// windows. Used by `track` and for place recognition.
TrackResult track_local_map(const TrackingInput& in, const SE3& T_reference_camera_guess, double window_px);

}  // namespace kinloop
