#pragma once
// In: a prepared frame, the previous frame, the local map and a predicted pose. Out: the frame's pose
// relative to the reference keyframe and the landmarks it sees. A pure function: what is remembered between
// frames is the caller's.

#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/tracking/frame.hpp"
#include "kinloop/tracking/motion_model.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

enum class TrackStatus {
  kTracked,    ///< by landmarks of the map, or by points of the frame before
  kDenseOnly,  ///< by aligning depth and grey images: features were too few
  kLost,
};

/// Keypoint `feature` of the frame shows `landmark`.
struct LandmarkMatch {
  LandmarkId landmark;
  uint32_t feature = 0;
};

struct TrackStats {
  int previous_frame_inliers = 0;  ///< inliers of the pose against the previous frame
  int visible_landmarks = 0;       ///< landmarks of the local map searched in the image
  int inliers = 0;                 ///< landmarks found and consistent
  int attempts = 0;                ///< ways of finding the previous frame that were needed (1 = the first)
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

/// Whether that share of the landmarks in sight was found; of many no more can be than the frame has
/// keypoints. Chance matches can agree on a wrong pose, but then few of the landmarks are where they should
/// be.
bool has_sufficient_inlier_ratio(const TrackResult& result, const Features& features,
                                 double min_inlier_ratio);

/// Finds the landmarks of `local_map` in `frame` near where `T_reference_camera_guess` puts them, and refines
/// the pose on them. `window_px` is the half side of the search windows. Used by `track` and to verify a
/// recognised place.
TrackResult track_local_map(const PreparedFrame& frame, const FeatureGrid& grid, const LocalMap& local_map,
                            const SE3& T_reference_camera_guess, double window_px,
                            const PinholeCamera& camera, const TrackingOptions& options);

}  // namespace kinloop
