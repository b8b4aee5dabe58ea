#pragma once
// In: a new keyframe and places that look like it. Out: the loop it closes, verified by geometry. The
// candidates is copied out of the map, so that it can be answered while tracking goes on.

#include <optional>

#include "kinloop/loop/candidates.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/loop/recognize_place.hpp"

namespace kinloop {

/// Whether `keyframe` shows one of `local_maps`.
struct LoopCandidates {
  KeyframeId keyframe;
  PreparedFrame frame;               ///< its features
  std::vector<LocalMap> local_maps;  ///< around each candidate, most alike first
  uint64_t seed = 0;
};

/// Where `keyframe` was found to be.
struct VerifiedLoop {
  KeyframeId keyframe;
  TrackResult result;
};

/// A verified loop: the edge, and landmarks of the keyframe that turn out to be landmarks of the old place.
struct LoopConstraint {
  LoopEdge edge;
  std::vector<std::pair<LandmarkId, LandmarkId>> merges;  ///< (from, into)
};

/// Copies what it takes to verify the candidates.
LoopCandidates make_loop_candidates(const Map& map, KeyframeId keyframe,
                                    const std::vector<KeyframeId>& keyframes,
                                    const LocalMapOptions& local_map, uint64_t seed);

/// Tries the places in turn and gives the first that `recognize_place` confirms.
std::optional<VerifiedLoop> verify_loop(const LoopCandidates& candidates, const PinholeCamera& camera,
                                        const LoopOptions& options, const TrackingOptions& tracking);

/// What the loop means to the map as it is now.
LoopConstraint make_loop_constraint(const Map& map, const VerifiedLoop& loop, const LoopOptions& options);

}  // namespace kinloop
