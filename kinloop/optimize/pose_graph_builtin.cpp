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
// An order of elimination that was kept while the graph grew is given up when it costs this much more.
constexpr double kMaxGrowthOfProducts = 1.5;

/// The earlier order with the new vertices last, or a new one where that has become too dear.
EliminationPlan plan_after(const PoseGraphElimination& earlier, const PoseGraphLayout& layout) {
  if (earlier.vertices.empty()) return plan_elimination(layout.pattern);
  std::vector<uint32_t> order;
  std::vector<bool> placed(layout.pattern.size, false);
  for (const uint32_t vertex : earlier.vertices) {
    const uint32_t block = layout.block_of_vertex[vertex];
    if (block == kNoBlock) continue;
    order.push_back(block);
    placed[block] = true;
  }
  for (uint32_t block = 0; block < placed.size(); ++block) {
    if (!placed[block]) order.push_back(block);
  }
  EliminationPlan kept = plan_elimination(layout.pattern, order);
  if (kept.factor_products <= kMaxGrowthOfProducts * earlier.planned_products) return kept;
  return plan_elimination(layout.pattern);
}

/// What the next solution needs to know of this one's plan.
PoseGraphElimination elimination_of(const EliminationPlan& plan, const PoseGraphLayout& layout,
                                    const PoseGraphElimination& earlier) {
  PoseGraphElimination elimination;
  elimination.vertices.resize(layout.pattern.size);
  for (uint32_t vertex = 0; vertex < layout.block_of_vertex.size(); ++vertex) {
    const uint32_t block = layout.block_of_vertex[vertex];
    if (block != kNoBlock) elimination.vertices[plan.position[block]] = vertex;
  }
  const bool was_kept = !earlier.vertices.empty() && !plan.is_fresh;
  elimination.planned_products = was_kept ? earlier.planned_products : plan.factor_products;
  return elimination;
}

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
                                     const PoseGraphOptions& options, const PoseGraphElimination& earlier) {
  const Stopwatch stopwatch;
  const PoseGraphKernel kernel = pose_graph_kernel(options.robust, options.robust_width);
  const PoseGraphLayout layout = layout_system(graph, held);
  const EliminationPlan plan = plan_after(earlier, layout);
  const DescentProblem<Pose> problem{graph, layout, options.method, options.max_iterations};
  NewtonSystems<Pose::kDof> newton(layout.pattern, plan);
  Descent<Pose> at{start_poses(graph, layout, plan, kernel, options.start), 0, 0, false};
  at = descend_or_narrow(problem, kernel, at, newton);
  return {std::move(at.T_world_vertex), at.iterations, stopwatch.wall_s(), at.converged,
          elimination_of(plan, layout, earlier)};
}

template SolvedPoses<SE3> solve_with_builtin(const PoseGraph&, const std::vector<bool>&,
                                             const PoseGraphOptions&, const PoseGraphElimination&);
template SolvedPoses<SE2> solve_with_builtin(const PoseGraph2&, const std::vector<bool>&,
                                             const PoseGraphOptions&, const PoseGraphElimination&);

}  // namespace kinloop
