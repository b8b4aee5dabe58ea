// The built-in solver: chordal initialization, Gauss-Newton steps within a trust region, and sparse systems
// with as few factorisations as possible.

#include <algorithm>
#include <cmath>

#include "kinloop/core/stopwatch.hpp"
#include "kinloop/optimize/pose_graph/chordal_initialization.hpp"
#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_minimizer.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_solvers.hpp"

namespace kinloop {
namespace {

constexpr double kNonConvexityStep = 1.4;  // as in Yang et al. 2020

/// Returns the initial poses; for kAuto the given poses, or the chordal ones if their cost is lower.
template <class Pose>
std::vector<Pose> initial_poses(const BasicPoseGraph<Pose>& graph, const PoseGraphLayout& layout,
                                const EliminationPlan& plan, const PoseGraphKernel& kernel,
                                PoseGraphStart start) {
  if (start == PoseGraphStart::kGiven) return graph.T_world_vertex;
  if (start == PoseGraphStart::kTree) return spanning_tree_poses(graph);
  auto chordal = chordal_initialization(graph, layout, plan);
  if (!chordal) return graph.T_world_vertex;
  const bool better = robust_cost(graph, kernel, *chordal) < robust_cost(graph, kernel, graph.T_world_vertex);
  return better || start == PoseGraphStart::kChordal ? *std::move(chordal) : graph.T_world_vertex;
}

/// Graduated non-convexity (Yang et al. 2020): starts with a kernel so wide that the cost is nearly least
/// squares and narrows it stepwise to the final width, which makes the minimum less dependent on the start.
template <class Pose>
MinimizerState<Pose> graduated_non_convexity(const MinimizerProblem<Pose>& problem,
                                             const PoseGraphKernel& kernel, MinimizerState<Pose> at,
                                             NewtonSolver<Pose::kDof>& newton) {
  double largest = 0;
  for (const auto& edge : problem.graph.edges) {
    if (!edge.is_odometry) largest = std::max(largest, edge_chi2(at.T_world_vertex, edge));
  }
  MinimizerProblem<Pose> one_step = problem;
  for (double wide = 2 * largest / (kernel.width * kernel.width); wide > 1; wide /= kNonConvexityStep) {
    one_step.max_iterations = std::min(at.iterations + 1, problem.max_iterations);
    at = minimize_pose_graph(one_step, {kernel.kind, kernel.width * std::sqrt(wide)}, std::move(at), newton);
  }
  return minimize_pose_graph(problem, kernel, std::move(at), newton);
}

/// Returns the lower of two minima: one by graduated non-convexity, which needs no good start but can twist a
/// chain of odometry edges before rejecting false ones, and one directly from the start, which does not.
template <class Pose>
MinimizerState<Pose> minimize_robust(const MinimizerProblem<Pose>& problem, const PoseGraphKernel& kernel,
                                     const MinimizerState<Pose>& start, NewtonSolver<Pose::kDof>& newton) {
  if (kernel.kind != RobustKernel::kGemanMcClure) return minimize_pose_graph(problem, kernel, start, newton);
  MinimizerState<Pose> direct = minimize_pose_graph(problem, kernel, start, newton);
  MinimizerState<Pose> graduated = graduated_non_convexity(problem, kernel, start, newton);
  const int iterations = direct.iterations + graduated.iterations;
  MinimizerState<Pose> lower = direct.cost < graduated.cost ? std::move(direct) : std::move(graduated);
  lower.iterations = iterations;
  return lower;
}

}  // namespace

template <class Pose>
SolvedPoses<Pose> solve_with_builtin(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                     const PoseGraphOptions& options) {
  const Stopwatch stopwatch;
  const PoseGraphKernel kernel = PoseGraphKernel{options.robust_kernel, options.robust_width};
  const PoseGraphLayout layout = make_pose_graph_layout(graph, held);
  const EliminationPlan plan = plan_elimination(layout.pattern);
  const MinimizerProblem<Pose> problem{graph, layout, options.method, options.max_iterations};
  NewtonSolver<Pose::kDof> newton(layout.pattern, plan);
  MinimizerState<Pose> at{initial_poses(graph, layout, plan, kernel, options.start), 0, 0, false};
  at = minimize_robust(problem, kernel, at, newton);
  return {std::move(at.T_world_vertex), at.iterations, stopwatch.wall_s(), at.converged};
}

template SolvedPoses<SE3> solve_with_builtin(const PoseGraph&, const std::vector<bool>&,
                                             const PoseGraphOptions&);
template SolvedPoses<SE2> solve_with_builtin(const PoseGraph2d&, const std::vector<bool>&,
                                             const PoseGraphOptions&);

}  // namespace kinloop
