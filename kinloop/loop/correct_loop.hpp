#pragma once
// Loop correction: distributes the drift over all keyframes of a map with loop closures.

#include <optional>
#include <vector>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// A pose graph over all keyframes, and the landmarks to merge after it is solved.
struct LoopCorrectionProblem {
  PoseGraph graph;  ///< vertex i is keyframe i
  LandmarkMerges merges;
  KeyframeId newest_keyframe;
  uint32_t epoch = 0;
};

/// Returns the keyframe preceding this one in time; nullopt if its motion from there is unknown.
std::optional<KeyframeId> predecessor(const Map& map, const Keyframe& keyframe);

/// Builds edges between successive keyframes and between keyframes that share many landmarks, from their
/// current poses, and an edge for each loop closure, as measured. The first `corrected_loops` loop closures
/// are an exception: the map has been corrected for them and their landmarks are merged and adjusted, so
/// their edges use the current poses too, which are better than the measurement. The first keyframe of each
/// component is constant.
PoseGraph make_pose_graph(const Map& map, const LoopOptions& options, size_t corrected_loops = 0);

/// Returns the information matrix of a relative pose constrained by `shared` landmarks, for (translation;
/// quaternion vector part) as in pose_graph.hpp.
Matrix6d edge_information(int shared, const LoopOptions& options);

/// Copies the problem; `merges` are the landmarks identified by the loop closures after the first
/// `corrected_loops`.
LoopCorrectionProblem make_loop_correction_problem(const Map& map, LandmarkMerges merges,
                                                   const LoopOptions& options, size_t corrected_loops = 0);

/// Solves the pose graph. Landmarks move with their anchors.
MapUpdate correct_loop(const LoopCorrectionProblem& problem, const LoopOptions& options);

}  // namespace kinloop
