#pragma once
// In: a frame and a part of the map that may show the same place. Out: the frame's pose there, if it is
// certain. Loop closing and relocalisation both rest on it.

#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// The pose of `frame` relative to the reference of `local_map`: matches by descriptor alone, P3P with
/// RANSAC, guided matching of all landmarks in sight, refinement. Nothing unless `min_inliers` landmarks and
/// `min_inlier_ratio` of those that could be found agree, and neither the depths nor the pictures of the
/// frame and of the reference contradict each other.
std::optional<TrackResult> recognize_place(const PreparedFrame& frame, const LocalMap& local_map,
                                           const PinholeCamera& camera, const LoopOptions& options,
                                           const TrackingOptions& tracking, uint64_t seed);

}  // namespace kinloop
