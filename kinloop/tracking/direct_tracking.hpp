#pragma once
// Direct tracking: finds the landmarks of the local map in a frame by the image patches of their keyframes,
// without keypoint detection, in two steps as SVO does (Forster et al. 2014): alignment of the image with the
// previous one, then of each patch alone. Depth is measured, so there is no depth filter.

#include <optional>

#include "kinloop/features/options.hpp"
#include "kinloop/tracking/local_map_tracking.hpp"
#include "kinloop/tracking/patch_search.hpp"

namespace kinloop {

/// What direct tracking needs besides the frame.
struct DirectTrackingContext {
  const TrackedFrame& previous;
  PatchSearch search;  ///< with the predicted velocity of the frame
  const FeatureOptions& features;
  const TrackingOptions& options;
};

/// A frame located without keypoints.
struct DirectlyTracked {
  TrackResult result;
  std::shared_ptr<const Features> features;  ///< the landmarks found, as measured, without descriptors
};

/// Tracks `frame` from the predicted T_reference_camera. nullopt if too few landmarks have patches, are
/// found, or agree.
std::optional<DirectlyTracked> track_directly(const PreparedFrame& frame, const SE3& T_reference_predicted,
                                              const DirectTrackingContext& context);

}  // namespace kinloop
