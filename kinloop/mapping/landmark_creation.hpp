#pragma once
// In: a frame that became a keyframe. Out: the map with its observations and new landmarks.

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// Notes the landmarks that the tracker matched.
void add_observations(Map& map, KeyframeId keyframe, const std::vector<LandmarkMatch>& matches);

/// Landmarks of `local_map` (whose reference is `keyframe`) that the keyframe does not see yet, at the
/// keypoints where they must appear.
std::vector<LandmarkMatch> find_unobserved_landmarks(const Map& map, KeyframeId keyframe,
                                                     const LocalMap& local_map, const PinholeCamera& camera,
                                                     const MappingOptions& options);

/// Looks for landmarks of `local_map` (whose reference is `keyframe`) at keypoints that show none yet, so
/// that a place seen before keeps its landmarks. Returns how many were found.
int match_local_map(Map& map, KeyframeId keyframe, const LocalMap& local_map, const PinholeCamera& camera,
                    const MappingOptions& options);

/// Makes a landmark of every keypoint with depth that shows none yet. Returns how many.
int create_landmarks_from_depth(Map& map, KeyframeId keyframe, const PinholeCamera& camera,
                                const MappingOptions& options);

/// Erases landmarks first seen `cull_after_keyframes` ago that too few keyframes have confirmed since.
/// Returns how many.
int cull_landmarks(Map& map, const MappingOptions& options);

}  // namespace kinloop
