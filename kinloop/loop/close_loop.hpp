#pragma once
// In: a new keyframe. Out: the loop it closes, verified by geometry.

#include <optional>

#include "kinloop/loop/candidates.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/loop/recognize.hpp"

namespace kinloop {

/// A verified loop: the edge, and landmarks of the keyframe that turn out to be landmarks of the old place.
struct LoopClosure {
  LoopEdge edge;
  std::vector<std::pair<LandmarkId, LandmarkId>> merges;  ///< (goes, stays)
};

/// Tries the candidates in turn and gives the first that `recognize_place` confirms.
std::optional<LoopClosure> verify_loop(const Map& map, KeyframeId keyframe,
                                       const std::vector<KeyframeId>& candidates, const PinholeCamera& camera,
                                       const LocalViewOptions& view, const LoopOptions& options,
                                       const TrackingOptions& tracking, uint64_t seed);

}  // namespace kinloop
