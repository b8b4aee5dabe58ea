#pragma once
// Track completion: adds missing observations across keyframes to a map with accurate poses.

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// Searches every keyframe for the landmarks of the surrounding keyframes, at their projections. Tracking
/// misses many, above all around a loop closure, where the keyframes of the second visit created their own
/// landmarks before the loop was detected. Two landmarks found at the same keypoint are merged, unless some
/// keyframe observes both (track completion and merging of Schoenberger and Frahm 2016, section 4.3).
void complete_tracks(Map& map, const PinholeCamera& camera, const LocalMapOptions& local_map,
                     const MappingOptions& options);

}  // namespace kinloop
