#pragma once
// Track completion: adds missing observations across keyframes to a map with accurate poses.

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// Matches the landmarks of covisible keyframes, and of others with a similar view, with the keypoints of
/// every keyframe at their projections. Tracking misses many of these matches, especially around a loop
/// closure, where the keyframes of the second visit created new landmarks before the loop was detected. Two
/// landmarks matched to the same keypoint are merged, unless some keyframe observes both (track completion
/// and merging of Schoenberger and Frahm 2016, section 4.3).
void complete_tracks(Map& map, const PinholeCamera& camera, const LocalMapOptions& local_map,
                     const MappingOptions& options);

}  // namespace kinloop
