#pragma once
// Adds the observations of a new keyframe and creates its landmarks.

#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
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

// Triangulates landmarks for keypoints without depth from two views.

/// A keypoint as a bearing: its ray in camera axes, and the angle of its uncertainty.
struct Bearing {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();  ///< unit vector
  double sigma_rad = 0;
};

/// Returns, in the frame of camera a, the point between the two rays where they are closest, weighted by
/// their sigmas (Lee and Civera 2019, "Triangulation: why optimize?": such a midpoint suffices at the
/// parallaxes required here, and adjustment does the rest). nullopt if the rays are nearly parallel, meet
/// behind a camera, or are farther apart than 95 % of pairs with these sigmas.
std::optional<Eigen::Vector3d> triangulate(const Bearing& a, const Bearing& b, const SE3& T_a_b,
                                           double min_parallax_rad);

/// Triangulates keypoints without depth that the keyframe shares with its covisible neighbours. Returns the
/// number of new landmarks.
int triangulate_landmarks(Map& map, KeyframeId keyframe, const PinholeCamera& camera,
                          const MappingOptions& options);

// Track completion: adds missing observations across keyframes to a map with accurate poses.

/// Matches the landmarks of covisible keyframes, and of others with a similar view, with the keypoints of
/// every keyframe at their projections. Tracking misses many of these matches, especially around a loop
/// closure, where the keyframes of the second visit created new landmarks before the loop was detected. Two
/// landmarks matched to the same keypoint are merged, unless some keyframe observes both (track completion
/// and merging of Schoenberger and Frahm 2016, section 4.3).
void complete_tracks(Map& map, const PinholeCamera& camera, const LocalMapOptions& local_map,
                     const MappingOptions& options);

}  // namespace kinloop
