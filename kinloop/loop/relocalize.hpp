#pragma once
// Relocalization: finds the pose of a frame in the map after tracking loss.

#include <optional>

#include "kinloop/loop/recognize_place.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

/// Estimates the pose of `frame` relative to the most similar keyframe that passes geometric verification
/// (the result's `reference`). `bow` is the frame's bag of words.
std::optional<TrackedFrame> relocalize(const Frame& frame, const BowVector& bow, const Map& map,
                                       const PlaceIndex& index, const PinholeCamera& camera,
                                       const LocalMapOptions& local_map, const LoopOptions& options,
                                       const TrackingOptions& tracking, uint64_t seed);

}  // namespace kinloop
