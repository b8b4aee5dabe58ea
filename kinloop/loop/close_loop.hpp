#pragma once
// In: a new keyframe and places that look like it. Out: the loop it closes, verified by geometry. The
// question is copied out of the map, so that it can be answered while tracking goes on.

#include <optional>

#include "kinloop/loop/candidates.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/loop/recognize.hpp"

namespace kinloop {

/// Whether `keyframe` shows one of `places`.
struct LoopQuestion {
  KeyframeId keyframe;
  PreparedFrame frame;            ///< its features
  std::vector<LocalView> places;  ///< around each candidate, most alike first
  uint64_t seed = 0;
};

/// Where `keyframe` was found to be.
struct LoopAnswer {
  KeyframeId keyframe;
  TrackResult found;
};

/// A verified loop: the edge, and landmarks of the keyframe that turn out to be landmarks of the old place.
struct LoopClosure {
  LoopEdge edge;
  std::vector<std::pair<LandmarkId, LandmarkId>> merges;  ///< (goes, stays)
};

/// Copies what it takes to verify the candidates.
LoopQuestion loop_question(const Map& map, KeyframeId keyframe, const std::vector<KeyframeId>& candidates,
                           const LocalViewOptions& view, uint64_t seed);

/// Tries the places in turn and gives the first that `recognize_place` confirms.
std::optional<LoopAnswer> verify_loop(const LoopQuestion& question, const PinholeCamera& camera,
                                      const LoopOptions& options, const TrackingOptions& tracking);

/// What the answer means to the map as it is now.
LoopClosure closure_of(const Map& map, const LoopAnswer& answer, const LoopOptions& options);

}  // namespace kinloop
