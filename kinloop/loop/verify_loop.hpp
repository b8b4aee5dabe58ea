#pragma once
// Loop verification for a new keyframe and its loop candidates. The input is copied out of the map, so that
// verification can run while tracking continues.

#include <optional>

#include "kinloop/loop/candidates.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/loop/propose_loop.hpp"
#include "kinloop/loop/recognize_place.hpp"

namespace kinloop {

/// A loop to verify, with the local map around its reference.
struct LoopCandidate {
  ProposedLoop proposed;
  LocalMap local_map;
};

/// A keyframe and the loops proposed for it.
struct LoopCandidates {
  KeyframeId keyframe;
  Frame frame;                        ///< its features
  std::vector<LoopCandidate> places;  ///< most similar first
};

/// The pose of `keyframe` relative to the place it revisits.
struct VerifiedLoop {
  KeyframeId keyframe;
  TrackedFrame result;
};

/// A verified loop: the edge, and landmark pairs of the keyframe and the old place to merge.
struct LoopConstraint {
  LoopEdge edge;
  std::vector<std::pair<LandmarkId, LandmarkId>> merges;  ///< (from, into)
};

/// Copies the data needed to verify the loops proposed for `keyframe`.
LoopCandidates make_loop_candidates(const Map& map, KeyframeId keyframe,
                                    const std::vector<ProposedLoop>& proposed,
                                    const LocalMapOptions& local_map);

/// Verifies the candidates in order and returns the first that `confirm_pose` confirms and drift explains.
std::optional<VerifiedLoop> verify_loop(const LoopCandidates& candidates, const Sensor& sensor,
                                        const LoopOptions& options, const TrackingOptions& tracking);

/// Converts a verified loop to a constraint on the current map.
LoopConstraint make_loop_constraint(const Map& map, const VerifiedLoop& loop, const LoopOptions& options);

}  // namespace kinloop
