#pragma once
// Minimizes the robust cost of a pose graph from given poses to the nearest minimum.

#include <vector>

#include "kinloop/optimize/pose_graph/solvers/newton_solver.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_system.hpp"

namespace kinloop {

/// State of the minimization.
template <class Pose>
struct MinimizerState {
  std::vector<Pose> T_world_vertex;
  double cost = 0;  ///< sum of rho(e' Omega e)
  int iterations = 0;
  bool converged = false;
};

/// Constant data of the minimization.
template <class Pose>
struct MinimizerProblem {
  const BasicPoseGraph<Pose>& graph;  ///< only edges are used, not poses
  const PoseGraphLayout& layout;
  PoseGraphMethod method = PoseGraphMethod::kAuto;
  int max_iterations = 0;
};

/// Continues the minimization at `from` until the cost converges or `max_iterations` are done in total. The
/// cost never rises, except with Gauss-Newton. `newton` keeps its factor for the next call.
template <class Pose>
MinimizerState<Pose> minimize_pose_graph(const MinimizerProblem<Pose>& problem, const PoseGraphKernel& kernel,
                                         MinimizerState<Pose> from, NewtonSolver<Pose::kDof>& newton);

}  // namespace kinloop
