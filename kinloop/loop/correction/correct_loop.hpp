#pragma once
// Loop correction: distributes the drift over all keyframes of a map with loop closures, and finds the loop
// closures that are false.

#include <optional>
#include <vector>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// The motion between neighbouring keyframes as it was before any loop bent the map: what is needed to take a
/// loop back. A keyframe enters when the first loop after it is corrected, after its local adjustment.
class OdometryBeforeLoops {
 public:
  /// Takes over the keyframes that are new.
  void observe(const Map& map, const LoopOptions& options);

  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const { return edges_; }

 private:
  uint32_t observed_ = 0;  // keyframes
  std::vector<PoseGraphEdge> edges_;
};

/// A pose graph over all keyframes, and the landmarks to merge after it is solved.
struct LoopCorrectionProblem {
  PoseGraph graph;                      ///< vertex i is keyframe i; the edges of `loops` come last
  std::vector<LoopClosure> loops;       ///< all of the map
  std::vector<PoseGraphEdge> odometry;  ///< before any loop bent the map
  std::vector<LoopMerges> merges;       ///< of the loops that the map has not been corrected for
  KeyframeId newest_keyframe;
  uint32_t epoch = 0;
};

/// The relative poses of loop closures in a pose graph.
enum class LoopEdges {
  kAsMeasured,
  /// By the current poses where the map has been corrected for the loop: its landmarks are merged and
  /// adjusted then, so that these are better than the measurement.
  kAsCorrected,
};

/// Builds edges between successive keyframes and between keyframes that share many landmarks, from their
/// current poses, and last an edge for each loop closure. The first keyframe of each component is constant.
PoseGraph make_pose_graph(const Map& map, const LoopOptions& options,
                          LoopEdges loops = LoopEdges::kAsMeasured);

/// Returns the information matrix of a relative pose constrained by `shared` landmarks, for (translation;
/// quaternion vector part) as in pose_graph.hpp.
Matrix6d edge_information(int shared, const LoopOptions& options);

/// Copies the problem; `merges` are those of the loop closures that the map has not been corrected for.
LoopCorrectionProblem make_loop_correction_problem(const Map& map, std::vector<LoopMerges> merges,
                                                   const OdometryBeforeLoops& odometry,
                                                   const LoopOptions& options);

/// Corrected poses, and the loop closures that are false.
struct LoopCorrection {
  MapUpdate update;
  std::vector<LoopMerges> merges;   ///< as in the problem; `update` has those of loops that fit
  std::vector<LoopEnds> loops;      ///< that the poses are corrected for
  std::vector<LoopEnds> withdrawn;  ///< that do not fit
};

/// Solves the pose graph. Landmarks move with their anchors.
///
/// If a loop closure does not fit the solution (chi2 of its covariance), all loop closures and the odometry
/// as it was before any of them are solved by graduated non-convexity with the kernel of Geman and McClure
/// (Yang et al. 2020), and those whose weight ends near zero are withdrawn. If the map had been corrected for
/// one of those, its poses become that solution; otherwise the graph is solved without the withdrawn ones.
LoopCorrection correct_loop(const LoopCorrectionProblem& problem, const LoopOptions& options);

}  // namespace kinloop
