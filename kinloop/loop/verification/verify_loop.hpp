#pragma once
// Verifies that two keyframes close a loop, the cheap stages first. `propose_pose` needs no landmarks; most
// wrong candidates end there. `verify_loop` works on a problem copied out of the map, so that it can run
// while tracking continues.

#include <optional>
#include <vector>

#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// The keypoints of a keyframe and their nodes of the vocabulary.
struct IndexedView {
  const Features& features;
  const std::vector<NodeId>& nodes;
};

/// Two keyframes that may show one place.
struct ViewPair {
  IndexedView reference, camera;
  const std::optional<PredictedView>& predicted;  ///< of the camera relative to the reference
};

/// Estimates the pose of the camera relative to the reference from their keypoints alone: matching by
/// vocabulary nodes, matches against `predicted` dropped, P3P with RANSAC. nullopt if too few agree.
std::optional<SE3> propose_pose(const ViewPair& views, const PlaceContext& context, uint64_t seed);

/// A keyframe and the loops that it may close, with copies of all that their verification needs.
struct LoopVerificationProblem {
  struct Candidate {
    LoopClosure hypothesis;                  ///< `b` is the keyframe
    std::optional<PredictedView> predicted;  ///< nullopt between components
    LocalMap local_map;                      ///< around `hypothesis.a`
  };
  Frame frame;                        ///< the keyframe's features
  std::vector<Candidate> candidates;  ///< most similar first
};

/// A verified loop closure, and the landmarks around `loop.a` that keypoints of `loop.b` match.
struct LoopVerificationResult {
  LoopClosure loop;
  std::vector<LandmarkMatch> matches;
};

/// Returns the problem of a keyframe, without candidates.
LoopVerificationProblem make_loop_verification_problem(const Keyframe& keyframe);

/// Verifies the candidates in order and returns those that `confirm_pose` confirms and drift explains. They
/// may contradict each other.
std::vector<LoopVerificationResult> verify_loops(const LoopVerificationProblem& problem,
                                                 const PlaceContext& context);

/// Returns the landmarks that a verified loop identifies, as pairs (of `loop.b`, matched).
LandmarkMerges landmark_merges(const Map& map, const LoopVerificationResult& verified);

// Which keyframes could support a loop that waits for others.

/// Returns the hypotheses that follow from a verified loop for the keyframes around it: those that share
/// landmarks with `loop.b` may see the place of `loop.a`, and the other way round. Pieces of a recording
/// overlap in a few keyframes only, not all of which place recognition finds. Their `support` is 2, with
/// which `verify_loops` asks for fewer inliers.
std::vector<LoopVerificationProblem> seek_support(const Map& map, const LoopClosure& loop,
                                                  const LocalMapOptions& options);

}  // namespace kinloop
