#pragma once
// Pose graph optimization: estimates the poses that minimize the sum of e' Omega e over measured relative
// poses.
//
// The error of an edge is that of g2o's EDGE_SE3:QUAT and EDGE_SE2, so that chi2 values agree exactly:
//   E = T_a_b^-1 * (T_world_a^-1 * T_world_b),
//   3D: e = (translation; x, y, z of the unit quaternion with w >= 0) of E,
//   2D: e = (translation; angle) of E.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/se2.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Value of `PoseGraphEdge::a` for a prior: `T_a_b` then measures T_world_b itself.
inline constexpr uint32_t kWorld = std::numeric_limits<uint32_t>::max();

/// Poses and measured relative poses between them; `Pose` is SE3 or SE2.
template <class Pose>
struct BasicPoseGraph {
  using Vector = Eigen::Matrix<double, Pose::kDof, 1>;
  using Matrix = Eigen::Matrix<double, Pose::kDof, Pose::kDof>;

  struct Edge {
    uint32_t a = 0, b = 0;  ///< vertex indices; `a` may be kWorld
    Pose T_a_b;
    Matrix information = Matrix::Identity();  ///< of e, symmetric positive semi-definite
    bool is_odometry = false;                 ///< keeps full weight under any robust kernel (odometry)
  };

  std::vector<Pose> T_world_vertex;  ///< starting values
  /// Vertices held constant. If empty, or if a connected component has neither a fixed vertex nor a prior,
  /// the first vertex of each such component is fixed.
  std::vector<bool> fixed;
  std::vector<Edge> edges;
};

using PoseGraph = BasicPoseGraph<SE3>;
using PoseGraphEdge = PoseGraph::Edge;
using PoseGraph2d = BasicPoseGraph<SE2>;
using PoseGraphEdge2d = PoseGraph2d::Edge;

enum class PoseGraphSolver { kAuto, kBuiltin, kCeres, kG2o };

constexpr auto option_names(PoseGraphSolver) {
  using enum PoseGraphSolver;
  return std::to_array<EnumName<PoseGraphSolver>>(
      {{kAuto, "auto"}, {kBuiltin, "builtin"}, {kCeres, "ceres"}, {kG2o, "g2o"}});
}

/// Step selection of a solver.
enum class PoseGraphMethod { kAuto, kLevenberg, kGaussNewton, kDogleg };

constexpr auto option_names(PoseGraphMethod) {
  using enum PoseGraphMethod;
  return std::to_array<EnumName<PoseGraphMethod>>(
      {{kAuto, "auto"}, {kLevenberg, "levenberg"}, {kGaussNewton, "gauss-newton"}, {kDogleg, "dogleg"}});
}

/// Initial poses of a solver.
enum class PoseGraphStart { kAuto, kGiven, kTree, kChordal };

constexpr auto option_names(PoseGraphStart) {
  using enum PoseGraphStart;
  return std::to_array<EnumName<PoseGraphStart>>(
      {{kAuto, "auto"}, {kGiven, "given"}, {kTree, "tree"}, {kChordal, "chordal"}});
}

/// Robust kernel, which bounds the influence of outlier edges.
enum class RobustKernel { kNone, kHuber, kCauchy, kGemanMcClure, kDcs };

constexpr auto option_names(RobustKernel) {
  using enum RobustKernel;
  return std::to_array<EnumName<RobustKernel>>({{kNone, "none"},
                                                {kHuber, "huber"},
                                                {kCauchy, "cauchy"},
                                                {kGemanMcClure, "geman-mcclure"},
                                                {kDcs, "dcs"}});
}

struct PoseGraphOptions {
  PoseGraphSolver solver = PoseGraphSolver::kAuto;
  PoseGraphMethod method = PoseGraphMethod::kAuto;
  PoseGraphStart start = PoseGraphStart::kAuto;
  int max_iterations = 100;
  RobustKernel robust_kernel = RobustKernel::kNone;
  double robust_width = 3.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("solver", self.solver, "solver; auto: builtin");
    visit("method", self.method, "step strategy; auto: dogleg (builtin), levenberg (g2o, ceres)", Expert{});
    visit("start", self.start,
          "initialisation: the given poses, a spanning tree, or rotations then translations by linear least "
          "squares; auto: the best of given and chordal (built-in), given (g2o, ceres)",
          Expert{});
    visit("max_iterations", self.max_iterations, "maximum number of iterations", Range{0, 100000}, Expert{});
    visit("robust_kernel", self.robust_kernel, "robust kernel against outlier edges");
    visit("robust_width", self.robust_width, "kernel width (delta), standard deviations", Range{1e-3, 1e6},
          Expert{});
  }
};

/// Result of a solver.
template <class Pose>
struct BasicPoseGraphSolution {
  std::vector<Pose> T_world_vertex;
  double chi2_before = 0;  ///< sum of e' Omega e at the start, without robust kernel
  double chi2_after = 0;   ///< sum of e' Omega e at the solution, without robust kernel
  int iterations = 0;
  double seconds = 0;  ///< solver time
  bool converged = false;
  PoseGraphSolver solver = PoseGraphSolver::kBuiltin;  ///< the solver used, never kAuto
};

using PoseGraphSolution = BasicPoseGraphSolution<SE3>;
using PoseGraphSolution2d = BasicPoseGraphSolution<SE2>;

// The functions below are instantiated for Pose = SE3 and Pose = SE2.

/// Solves the graph. Deterministic. Throws std::logic_error for indices out of range or values that are not
/// finite, and UsageError for a solver missing from this build.
template <class Pose>
BasicPoseGraphSolution<Pose> solve_pose_graph(const BasicPoseGraph<Pose>& graph,
                                              const PoseGraphOptions& options = {});

/// Returns whether this build has the solver; always true for kAuto.
bool pose_graph_solver_available(PoseGraphSolver solver);

/// Returns the sum of e' Omega e over edges.
template <class Pose>
double chi2(const BasicPoseGraph<Pose>& graph);

/// Returns poses chained along breadth-first spanning trees from the vertices that are fixed or have a prior;
/// ignores the starting values of all others.
template <class Pose>
std::vector<Pose> spanning_tree_poses(const BasicPoseGraph<Pose>& graph);

/// Returns the number of connected components of the graph.
template <class Pose>
size_t count_connected_components(const BasicPoseGraph<Pose>& graph);

// Marginal covariances of the poses of a solved pose graph.

/// Returns the marginal covariance of each vertex's tangent vector d in T_world_vertex * (d_translation;
/// exp(d_rotation)), i.e. in the vertex's own frame, given exact fixed vertices (zero for these). nullopt if
/// the measurements do not determine all poses.
template <class Pose>
std::optional<std::vector<typename BasicPoseGraph<Pose>::Matrix>> marginal_covariances(
    const BasicPoseGraph<Pose>& graph, std::span<const uint32_t> vertices);

}  // namespace kinloop
