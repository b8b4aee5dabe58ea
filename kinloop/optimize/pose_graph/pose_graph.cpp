#include "kinloop/optimize/pose_graph/pose_graph.hpp"

#include "kinloop/core/errors.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/optimize/pose_graph/chordal_initialization.hpp"
#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_solvers.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_structure.hpp"

namespace kinloop {
namespace {

template <class Pose>
void check(const BasicPoseGraph<Pose>& graph) {
  const size_t count = graph.T_world_vertex.size();
  require(graph.fixed.empty() || graph.fixed.size() == count,
          "pose graph: one `fixed` flag per vertex, or none");
  for (const Pose& T : graph.T_world_vertex) require(T.is_finite(), "pose graph: a pose is not finite");
  for (const auto& edge : graph.edges) {
    require((edge.a < count || edge.a == kWorld) && edge.b < count,
            "pose graph: edge refers to an unknown vertex");
    require(edge.a != edge.b, "pose graph: edge connects a vertex to itself");
    require(edge.T_a_b.is_finite() && edge.information.allFinite(), "pose graph: an edge is not finite");
  }
}

/// Throws UsageError for values that `--set` rejects.
void check(const PoseGraphOptions& options) {
  validate(options);
  if (pose_graph_solver_available(options.solver)) return;
  throw UsageError(
      "solver g2o: not available in this build; use builtin or ceres, or install g2o and rebuild");
}

template <class Pose>
SolvedPoses<Pose> solve_with(PoseGraphSolver solver, const BasicPoseGraph<Pose>& graph,
                             const std::vector<bool>& held, const PoseGraphOptions& options) {
#ifdef KINLOOP_WITH_G2O
  if (solver == PoseGraphSolver::kG2o) return solve_with_g2o(graph, held, options);
#endif
  if (solver == PoseGraphSolver::kCeres) return solve_with_ceres(graph, held, options);
  return solve_with_builtin(graph, held, options);
}

/// Whether any vertex with an edge is free.
template <class Pose>
bool has_free_vertices(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held) {
  for (const auto& edge : graph.edges) {
    if (!held[edge.b] || (edge.a != kWorld && !held[edge.a])) return true;
  }
  return false;
}

/// Computes the initial poses by a method that the solver itself does not provide.
template <class Pose>
std::vector<Pose> initial_poses(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                const PoseGraphOptions& options) {
  if (options.start == PoseGraphStart::kTree) return spanning_tree_poses(graph);
  if (options.start != PoseGraphStart::kChordal) return graph.T_world_vertex;
  const PoseGraphLayout layout = make_pose_graph_layout(graph, held);
  const auto chordal = chordal_initialization(graph, layout, plan_elimination(layout.pattern));
  return chordal ? *chordal : graph.T_world_vertex;
}

}  // namespace

template <class Pose>
BasicPoseGraphSolution<Pose> solve_pose_graph(const BasicPoseGraph<Pose>& graph,
                                              const PoseGraphOptions& options) {
  check(graph);
  check(options);
  BasicPoseGraphSolution<Pose> solution;
  solution.solver = options.solver == PoseGraphSolver::kAuto ? PoseGraphSolver::kBuiltin : options.solver;
  solution.chi2_before = chi2(graph);
  solution.converged = true;

  BasicPoseGraph<Pose> working = graph;
  const std::vector<bool> held = fixed_vertices(graph);
  if (has_free_vertices(graph, held)) {
    const Stopwatch stopwatch;
    if (solution.solver != PoseGraphSolver::kBuiltin)
      working.T_world_vertex = initial_poses(graph, held, options);
    solution.seconds = stopwatch.wall_s();
    SolvedPoses<Pose> solved = solve_with(solution.solver, working, held, options);
    working.T_world_vertex = std::move(solved.T_world_vertex);
    solution.iterations = solved.iterations;
    solution.seconds += solved.seconds;
    solution.converged = solved.converged;
  }
  solution.chi2_after = chi2(working);
  solution.T_world_vertex = std::move(working.T_world_vertex);
  return solution;
}

bool pose_graph_solver_available(PoseGraphSolver solver) {
#ifdef KINLOOP_WITH_G2O
  return !name_of(solver).empty();
#else
  return solver != PoseGraphSolver::kG2o;
#endif
}

template <class Pose>
double chi2(const BasicPoseGraph<Pose>& graph) {
  double sum = 0;
  for (const auto& edge : graph.edges) sum += edge_chi2(graph.T_world_vertex, edge);
  return sum;
}

template BasicPoseGraphSolution<SE3> solve_pose_graph(const PoseGraph&, const PoseGraphOptions&);
template BasicPoseGraphSolution<SE2> solve_pose_graph(const PoseGraph2d&, const PoseGraphOptions&);
template double chi2(const PoseGraph&);
template double chi2(const PoseGraph2d&);

}  // namespace kinloop
