#pragma once
// The three solvers behind solve_pose_graph. They take a checked graph with its starting values and the fixed
// vertices, and return poses. The caller computes chi2 and time.

#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// Result of a solver.
template <class Pose>
struct SolvedPoses {
  std::vector<Pose> T_world_vertex;
  int iterations = 0;
  double seconds = 0;  ///< excludes conversion of the problem to the solver's own form
  bool converged = false;
};

/// Relative decrease of the cost per step below which a solver stops.
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
