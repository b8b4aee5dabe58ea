#pragma once
// Relocalization: finds the pose of a frame in the map after tracking loss.

#include <optional>

#include "kinloop/loop/recognize_place.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

/// What a frame is searched in, and how.
struct PlaceSearch {
  const Map& map;
  const PlaceIndex& index;
  const Sensor& sensor;
  const PlaceOptions& options;
};

/// Estimates the pose of `frame` relative to the most similar keyframe that passes geometric verification
/// (the result's `reference`). `bow` is the frame's bag of words.
std::optional<TrackedFrame> relocalize(const Frame& frame, const BowVector& bow, const PlaceSearch& search,
                                       uint64_t seed);

}  // namespace kinloop
