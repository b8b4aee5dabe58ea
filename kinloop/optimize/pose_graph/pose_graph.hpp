#pragma once
// In: poses with starting values, and measured relative poses between them. Out: the poses that agree best
// with all measurements, sum over edges of e' Omega e at its smallest.
//
// The error of an edge is that of g2o's EDGE_SE3:QUAT and EDGE_SE2, so that chi2 is comparable to the digit:
//   E = T_a_b^-1 * (T_world_a^-1 * T_world_b),
//   e = (translation; x, y, z of the unit quaternion with w >= 0) of E in space, (translation; angle) in the
//   plane.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "kinloop/base/options.hpp"
#include "kinloop/geometry/se2.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// In place of `PoseGraphEdge::a`: the edge is a prior, `T_a_b` measures T_world_b itself.
inline constexpr uint32_t kWorld = std::numeric_limits<uint32_t>::max();

/// Poses and the relative poses measured between them; `Pose` is SE3 or SE2.
template <class Pose>
struct BasicPoseGraph {
  using Vector = Eigen::Matrix<double, Pose::kDof, 1>;
  using Matrix = Eigen::Matrix<double, Pose::kDof, Pose::kDof>;

  struct Edge {
    uint32_t a = 0, b = 0;  ///< vertex indices; `a` may be kWorld
    Pose T_a_b;
    Matrix information = Matrix::Identity();  ///< of e, symmetric positive semi-definite
    bool trusted = false;                     ///< keeps its full weight whatever the robust kernel (odometry)
  };

  std::vector<Pose> T_world_vertex;  ///< starting values
  /// Held where they are. When empty, or where a connected part has neither a fixed vertex nor a prior, the
  /// first vertex of each part is held.
  std::vector<bool> fixed;
  std::vector<Edge> edges;
};

using PoseGraph = BasicPoseGraph<SE3>;
using PoseGraphEdge = PoseGraph::Edge;
using PoseGraph2d = BasicPoseGraph<SE2>;
using PoseGraphEdge2d = PoseGraph2d::Edge;

struct PoseGraphOptions {
  std::string solver = "auto";
  std::string method = "auto";
  std::string start = "auto";
  int max_iterations = 100;
  std::string robust_kernel = "none";
  double robust_width = 3.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("solver", self.solver, "solver; auto: builtin", Choices{{"auto", "builtin", "ceres", "g2o"}});
    visit("method", self.method, "step strategy; auto: dogleg (builtin), levenberg (g2o, ceres)",
          Choices{{"auto", "levenberg", "gauss-newton", "dogleg"}});
    visit("start", self.start,
          "initialization: the given poses, a spanning tree, or rotations then translations "
          "by "
          "linear least squares; auto: the best of given and chordal (built-in), given (g2o, ceres)",
          Choices{{"auto", "given", "tree", "chordal"}});
    visit("max_iterations", self.max_iterations, "maximum number of iterations", Range{0, 100000});
    visit("robust_kernel", self.robust_kernel, "robust kernel against outlier edges",
          Choices{{"none", "huber", "cauchy", "geman-mcclure", "dcs"}});
    visit("robust_width", self.robust_width, "kernel width (delta), standard deviations", Range{1e-3, 1e6});
  }
};

/// In which order the built-in solver eliminated the vertices, for the next solution of the graph, grown.
struct PoseGraphEliminationOrder {
  std::vector<uint32_t> vertices;  ///< those that are free, the first to be eliminated first
  double planned_products = 0;  ///< block products of a factorisation when the order was last chosen afresh
};

/// What a solver found.
template <class Pose>
struct BasicPoseGraphSolution {
  std::vector<Pose> T_world_vertex;
  double chi2_before = 0;  ///< sum of e' Omega e at the start, without robust kernel
  double chi2_after = 0;   ///< the same at the solution
  int iterations = 0;
  double seconds = 0;  ///< solving alone
  bool converged = false;
  std::string solver;                     ///< the one that did it: builtin, ceres or g2o
  PoseGraphEliminationOrder elimination;  ///< empty but for the built-in solver
};

using PoseGraphSolution = BasicPoseGraphSolution<SE3>;
using PoseGraphSolution2d = BasicPoseGraphSolution<SE2>;

// The functions below exist for Pose = SE3 and Pose = SE2.

/// Solves the graph. Deterministic. Throws std::logic_error for indices out of range or values that are not
/// finite, and UsageError for a solver this build does not have.
template <class Pose>
BasicPoseGraphSolution<Pose> solve_pose_graph(const BasicPoseGraph<Pose>& graph,
                                              const PoseGraphOptions& options = {});

/// Solves a graph that has grown since `earlier` solved it: its vertices and edges come first, new ones
/// behind (fixed flags may change). The poses start from the earlier solution, to which the new ones are
/// chained; the built-in solver keeps the order of elimination, with the new vertices last, for as long as it
/// stays a good one. The minimum is that of solve_pose_graph.
template <class Pose>
BasicPoseGraphSolution<Pose> update_pose_graph_solution(const BasicPoseGraph<Pose>& graph,
                                                        const BasicPoseGraphSolution<Pose>& earlier,
                                                        const PoseGraphOptions& options = {});

/// Whether this build has the solver of that name ("builtin", "ceres", "g2o"; "auto" always).
bool pose_graph_solver_available(const std::string& name);

/// Sum over edges of e' Omega e.
template <class Pose>
double chi2(const BasicPoseGraph<Pose>& graph);

/// The poses chained along breadth-first spanning trees from the vertices that are held or have a prior;
/// ignores the starting values of all others.
template <class Pose>
std::vector<Pose> spanning_tree_poses(const BasicPoseGraph<Pose>& graph);

/// Number of parts of the graph that no edge connects.
template <class Pose>
size_t count_connected_components(const BasicPoseGraph<Pose>& graph);

}  // namespace kinloop
