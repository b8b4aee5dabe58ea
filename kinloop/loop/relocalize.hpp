#pragma once
// In: a frame that tracking lost. Out: where it is, if the map knows the place.

#include <optional>

#include "kinloop/loop/recognize_place.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

/// The pose of `frame` relative to the keyframe it resembles most among those that geometry confirms (the
/// result's `reference`). `bow` is the frame's bag of words.
std::optional<TrackResult> relocalize(const PreparedFrame& frame, const BowVector& bow, const Map& map,
                                      const PlaceIndex& index, const PinholeCamera& camera,
                                      const LocalMapOptions& local_map, const LoopOptions& options,
                                      const TrackingOptions& tracking, uint64_t seed);

}  // namespace kinloop
