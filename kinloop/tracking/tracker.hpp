#pragma once
// In: a prepared frame, the previous frame, the local view and a predicted pose. Out: the frame's pose
// relative to the reference keyframe and the landmarks it sees. A pure function: what is remembered between
// frames is the caller's.

#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_view.hpp"
#include "kinloop/tracking/frame.hpp"
#include "kinloop/tracking/motion_model.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

enum class TrackStatus {
  kTracked,    ///< by landmarks of the map, or by points of the frame before
  kDenseOnly,  ///< by aligning depth and grey images: features were too few
  kLost,
};

/// Key point `feature` of the frame shows `landmark`.
struct LandmarkMatch {
  LandmarkId landmark;
  uint32_t feature = 0;
};

struct TrackStats {
  int from_previous = 0;  ///< inliers of the pose against the previous frame
  int in_view = 0;        ///< landmarks of the local view searched in the image
  int inliers = 0;        ///< landmarks found and consistent
  int tries = 0;          ///< ways of finding the previous frame that were needed (1 = the first)
};

struct TrackResult {
  TrackStatus status = TrackStatus::kLost;
  KeyframeId reference;
  SE3 T_reference_camera;
  Matrix6d information = Matrix6d::Zero();  ///< of a right perturbation (translation; rotation)
  std::vector<LandmarkMatch> matches;
  TrackStats stats;
};

/// Tracks `frame` against `previous` and `view`, starting from the predicted T_reference_camera. `seed`
/// drives RANSAC.
TrackResult track(const PreparedFrame& frame, const TrackedFrame& previous, const LocalView& view,
                  const PredictedPose& predicted, const PinholeCamera& camera, const TrackingOptions& options,
                  uint64_t seed);

/// Whether that share of the landmarks in sight was found; of many no more can be than the frame has key
/// points. Chance matches can agree on a wrong pose, but then few of the landmarks are where they should be.
bool map_agrees(const TrackResult& result, const Features& features, double min_found_share);

/// Finds the landmarks of `view` in `frame` near where `T_reference_camera_guess` puts them, and refines the
/// pose on them. `window_px` is the half side of the search windows. Used by `track` and to verify a
/// recognised place.
TrackResult track_in_view(const PreparedFrame& frame, const FeatureGrid& grid, const LocalView& view,
                          const SE3& T_reference_camera_guess, double window_px, const PinholeCamera& camera,
                          const TrackingOptions& options);

}  // namespace kinloop
