#pragma once
// In: a sequence of sparse systems H d = b of one pattern, each close to the last. Out: their solutions,
// factorising only where the factor at hand is too old to be of use.

#include <optional>

#include <Eigen/Core>

#include "kinloop/optimize/pose_graph/sparse_cholesky.hpp"

namespace kinloop {

/// Solves the systems of Newton steps on B x B blocks. The factor of an earlier H preconditions conjugate
/// gradients (Hestenes and Stiefel 1952) on the present one: near a minimum two or three of their steps
/// replace a factorisation that costs ten times as much as one of them.
template <int B>
class NewtonSolver {
 public:
  /// Both must outlive this.
  NewtonSolver(const BlockPattern& pattern, const EliminationPlan& plan);

  /// d with H d = b, to within an error of the energy (error' H error) `negligible`; with a small multiple of
  /// H's diagonal added where H is singular, and nothing where even that does not help.
  std::optional<Eigen::VectorXd> solve(const BlockMatrix<B>& H, const Eigen::VectorXd& b, double negligible);

  /// d with (H + damping * diagonal) d = b.
  std::optional<Eigen::VectorXd> solve_damped(BlockMatrix<B> H, const Eigen::VectorXd& b, double damping);

 private:
  [[nodiscard]] std::optional<Eigen::VectorXd> solve_with_old_factor(const BlockMatrix<B>& H,
                                                                     const Eigen::VectorXd& b,
                                                                     double negligible) const;

  const BlockPattern* pattern_;
  SparseCholesky<B> cholesky_;
  int max_conjugate_steps_;
  bool has_factor_ = false;  ///< of an undamped H
};

/// The diagonal of the matrix, each entry at least a tiny share of the largest: the scale of each unknown.
template <int B>
Eigen::VectorXd diagonal_scale(const BlockMatrix<B>& H);

}  // namespace kinloop
