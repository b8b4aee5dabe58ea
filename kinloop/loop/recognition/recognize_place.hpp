#pragma once
// Place recognition: estimates the pose of a frame relative to a part of the map that may show the same
// place. Used by loop closing and relocalization.

#include <optional>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// Estimates the pose of the frame relative to the reference of the local map: descriptor matching, P3P with
/// RANSAC, guided matching of all visible landmarks, refinement. nullopt unless `min_inliers` landmarks and
/// `min_inlier_ratio` of the visible ones agree, and both the depth check and the appearance check against
/// the reference pass.
std::optional<TrackedFrame> recognize_place(const TrackingInput& in, const LoopOptions& options,
                                            uint64_t seed);

/// Confirms an initial pose, the second half of `recognize_place`: guided matching, refinement and checks.
std::optional<TrackedFrame> confirm_pose(const TrackingInput& in, const SE3& T_reference_camera,
                                         const LoopOptions& options);

}  // namespace kinloop
