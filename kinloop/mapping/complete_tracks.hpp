#pragma once
// In: a map whose poses are good. Out: the map with what its keyframes see of each other's landmarks.

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// Looks in every keyframe for the landmarks of the keyframes around it, where these must appear now.
/// Tracking misses many, above all where a loop was closed: a keyframe of the second visit grew landmarks of
/// its own before it was known where it is. Two landmarks found at the same keypoint are merged, unless some
/// keyframe tells them apart (the track completion and merging of Schoenberger and Frahm 2016, section 4.3).
void complete_tracks(Map& map, const PinholeCamera& camera, const LocalMapOptions& local_map,
                     const MappingOptions& options);

}  // namespace kinloop
