#pragma once
// In: a pose graph with its layout, and poses to start from. Out: the poses at the nearest minimum of the
// robust cost.

#include <vector>

#include "kinloop/optimize/pose_graph/newton_solver.hpp"
#include "kinloop/optimize/pose_graph/pose_graph_system.hpp"

namespace kinloop {

/// Poses on their way downhill.
template <class Pose>
struct MinimizerState {
  std::vector<Pose> T_world_vertex;
  double cost = 0;  ///< sum of rho(e' Omega e)
  int iterations = 0;
  bool converged = false;
};

/// What does not change on the way.
template <class Pose>
struct MinimizerProblem {
  const BasicPoseGraph<Pose>& graph;  ///< its edges; the poses are not looked at
  const PoseGraphLayout& layout;
  PoseGraphMethod method = PoseGraphMethod::kAuto;
  int max_iterations = 0;
};

/// Walks on from where `from` stands, until the cost stays or `max_iterations` are done in all. The cost
/// never rises, but with Gauss-Newton. `newton` keeps the factor from one walk to the next.
template <class Pose>
MinimizerState<Pose> minimize_pose_graph(const MinimizerProblem<Pose>& problem, const PoseGraphKernel& kernel,
                                         MinimizerState<Pose> from, NewtonSolver<Pose::kDof>& newton);

}  // namespace kinloop
