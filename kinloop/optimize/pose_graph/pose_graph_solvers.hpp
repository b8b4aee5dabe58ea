#pragma once
// The three solvers behind solve_pose_graph. In: a checked graph that holds its starting values, and which
// vertices do not move. Out: poses; chi2 and time are measured by the caller.

#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// What a solver returns.
template <class Pose>
struct SolvedPoses {
  std::vector<Pose> T_world_vertex;
  int iterations = 0;
  double seconds = 0;  ///< without copying the problem into the solver's own form
  bool converged = false;
};

/// Relative fall of the cost in one step below which a solver stops.
inline constexpr double kCostTolerance = 1e-9;

template <class Pose>
SolvedPoses<Pose> solve_with_builtin(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                     const PoseGraphOptions& options);

template <class Pose>
SolvedPoses<Pose> solve_with_ceres(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                   const PoseGraphOptions& options);

#ifdef KINLOOP_WITH_G2O
template <class Pose>
SolvedPoses<Pose> solve_with_g2o(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                 const PoseGraphOptions& options);
#endif

}  // namespace kinloop
