// The built-in solver: a start that needs no starting values, Gauss-Newton steps within a trust region, and
// sparse systems that are factorised as seldom as possible.

#include <algorithm>
#include <cmath>

#include "kinloop/base/stopwatch.hpp"
#include "kinloop/optimize/chordal_start.hpp"
#include "kinloop/optimize/pose_graph_descent.hpp"
#include "kinloop/optimize/pose_graph_error.hpp"
#include "kinloop/optimize/pose_graph_solvers.hpp"

namespace kinloop {
namespace {

constexpr double kNonConvexityStep = 1.4;  // as Yang et al. 2020

/// Where to start; "auto": the graph's own poses, or the chordal ones where they cost less.
template <class Pose>
std::vector<Pose> start_poses(const BasicPoseGraph<Pose>& graph, const PoseGraphLayout& layout,
                              const EliminationPlan& plan, const PoseGraphKernel& kernel,
                              const std::string& start) {
  if (start == "given") return graph.T_world_vertex;
  if (start == "tree") return spanning_tree_poses(graph);
  auto chordal = chordal_poses(graph, layout, plan);
  if (!chordal) return graph.T_world_vertex;
  const bool better = robust_cost(graph, kernel, *chordal) < robust_cost(graph, kernel, graph.T_world_vertex);
  return better || start == "chordal" ? *std::move(chordal) : graph.T_world_vertex;
}

/// Graduated non-convexity (Yang et al. 2020): a kernel so wide that the cost is nearly that of least squares
/// narrows step by step to the one that is wanted, so that the minimum found hangs less on the start.
template <class Pose>
Descent<Pose> narrow(const DescentProblem<Pose>& problem, const PoseGraphKernel& kernel, Descent<Pose> at,
                     NewtonSystems<Pose::kDof>& newton) {
  double largest = 0;
  for (const auto& edge : problem.graph.edges) {
    if (!edge.trusted) largest = std::max(largest, edge_chi2(at.T_world_vertex, edge));
  }
  DescentProblem<Pose> one_step = problem;
  for (double wide = 2 * largest / (kernel.width * kernel.width); wide > 1; wide /= kNonConvexityStep) {
    one_step.max_iterations = std::min(at.iterations + 1, problem.max_iterations);
    at = descend(one_step, {kernel.kind, kernel.width * std::sqrt(wide)}, std::move(at), newton);
  }
  return descend(problem, kernel, std::move(at), newton);
}

/// The lower of two minima: by graduated non-convexity, which needs no good start but can twist a chain of
/// trusted edges before it lets go of false ones, and straight from the start, which does not.
template <class Pose>
Descent<Pose> descend_or_narrow(const DescentProblem<Pose>& problem, const PoseGraphKernel& kernel,
                                const Descent<Pose>& start, NewtonSystems<Pose::kDof>& newton) {
  if (kernel.kind != PoseGraphKernel::Kind::kGemanMcClure) return descend(problem, kernel, start, newton);
  Descent<Pose> straight = descend(problem, kernel, start, newton);
  Descent<Pose> narrowed = narrow(problem, kernel, start, newton);
  const int iterations = straight.iterations + narrowed.iterations;
  Descent<Pose> lower = straight.cost < narrowed.cost ? std::move(straight) : std::move(narrowed);
  lower.iterations = iterations;
  return lower;
}

}  // namespace

template <class Pose>
SolvedPoses<Pose> solve_with_builtin(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                     const PoseGraphOptions& options) {
  const Stopwatch stopwatch;
  const PoseGraphKernel kernel = pose_graph_kernel(options.robust, options.robust_width);
  const PoseGraphLayout layout = layout_system(graph, held);
  const EliminationPlan plan = plan_elimination(layout.pattern);
  const DescentProblem<Pose> problem{graph, layout, options.method, options.max_iterations};
  NewtonSystems<Pose::kDof> newton(layout.pattern, plan);
  Descent<Pose> at{start_poses(graph, layout, plan, kernel, options.start), 0, 0, false};
  at = descend_or_narrow(problem, kernel, at, newton);
  return {std::move(at.T_world_vertex), at.iterations, stopwatch.wall_s(), at.converged};
}

template SolvedPoses<SE3> solve_with_builtin(const PoseGraph&, const std::vector<bool>&,
                                             const PoseGraphOptions&);
template SolvedPoses<SE2> solve_with_builtin(const PoseGraph2&, const std::vector<bool>&,
                                             const PoseGraphOptions&);

}  // namespace kinloop
