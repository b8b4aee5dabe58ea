#pragma once
// Direct tracking: finds the landmarks of the local map in a frame by the image patches of their keyframes,
// without keypoint detection, in two steps as SVO does (Forster et al. 2014): alignment of the image with the
// previous one, then of each patch alone. Depth is measured, so there is no depth filter.

#include <optional>

#include "kinloop/features/options.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/tracking/direct/patch_search.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// What direct tracking needs besides the frame.
struct DirectTrackingContext {
  const TrackedFrame& previous;
  PatchSearch search;  ///< with the predicted velocity of the frame
  const FeatureOptions& features;
  const TrackingOptions& options;
};

/// Tracks `frame` from the predicted T_reference_camera. The result's frame has the landmarks found as its
/// features, as measured, without descriptors. nullopt if too few landmarks have patches, are found, or
/// agree.
std::optional<TrackedFrame> track_directly(const Frame& frame, const SE3& T_reference_predicted,
                                           const DirectTrackingContext& context);

}  // namespace kinloop
