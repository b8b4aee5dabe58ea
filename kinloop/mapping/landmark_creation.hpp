#pragma once
// Adds the observations of a new keyframe and creates its landmarks.

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// Adds the observations of the landmarks matched by the tracker.
void add_observations(Map& map, KeyframeId keyframe, const std::vector<LandmarkMatch>& matches);

/// Returns landmarks of `local_map` (whose reference is `keyframe`) that the keyframe does not observe yet,
/// matched with keypoints at their projections.
std::vector<LandmarkMatch> find_unobserved_landmarks(const Map& map, KeyframeId keyframe,
                                                     const LocalMap& local_map, const PinholeCamera& camera,
                                                     const MappingOptions& options);

/// Matches landmarks of `local_map` (whose reference is `keyframe`) with keypoints that have no landmark yet,
/// so that a revisited place keeps its landmarks. Returns the number of matches.
int match_local_map(Map& map, KeyframeId keyframe, const LocalMap& local_map, const PinholeCamera& camera,
                    const MappingOptions& options);

/// Creates a landmark for every keypoint with depth that has none yet, except where points of its surfaces
/// are marked as `moved` (may be empty). Returns how many.
int create_landmarks_from_depth(Map& map, KeyframeId keyframe, const PinholeCamera& camera,
                                const MappingOptions& options, const cv::Mat& moved);

/// Erases landmarks created `cull_after_keyframes` keyframes ago that too few keyframes have confirmed since.
/// Returns how many.
int cull_landmarks(Map& map, const MappingOptions& options);

}  // namespace kinloop
