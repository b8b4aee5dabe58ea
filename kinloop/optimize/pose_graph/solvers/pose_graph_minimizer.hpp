#pragma once
// Minimizes the robust cost of a pose graph from given poses to the nearest minimum.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "kinloop/optimize/linear/sparse_cholesky.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_system.hpp"

namespace kinloop {

// Solves a sequence of similar sparse systems H d = b of one pattern, and refactorises only when the existing
// factor is too old.

/// Solves the systems of Newton steps on B x B blocks. The factor of an earlier H preconditions conjugate
/// gradients (Hestenes and Stiefel 1952) on the current one: near a minimum two or three iterations replace a
/// factorisation, which costs ten times as much as one iteration.
template <int B>
class NewtonSolver {
 public:
  /// Both must outlive this object.
  NewtonSolver(const BlockPattern& pattern, const EliminationPlan& plan);

  /// Returns d with H d = b, to within an error energy (error' H error) of `negligible`. If H is singular,
  /// adds a small multiple of its diagonal; nullopt if that fails too.
  std::optional<Eigen::VectorXd> solve(const BlockMatrix<B>& H, const Eigen::VectorXd& b, double negligible);

  /// Returns d with (H + damping * diagonal) d = b.
  std::optional<Eigen::VectorXd> solve_damped(BlockMatrix<B> H, const Eigen::VectorXd& b, double damping);

 private:
  [[nodiscard]] std::optional<Eigen::VectorXd> solve_with_old_factor(const BlockMatrix<B>& H,
                                                                     const Eigen::VectorXd& b,
                                                                     double negligible) const;

  const BlockPattern* pattern_;
  SparseCholesky<B> cholesky_;
  int max_conjugate_steps_;
  bool has_factor_ = false;  ///< factor of an undamped H
};

/// Returns the diagonal of the matrix, the scale of each unknown, with entries at least a tiny fraction of
/// the largest.
template <int B>
Eigen::VectorXd diagonal_scale(const BlockMatrix<B>& H);

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
