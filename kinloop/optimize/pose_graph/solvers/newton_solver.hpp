#pragma once
// Solves a sequence of similar sparse systems H d = b of one pattern, and refactorises only when the existing
// factor is too old.

#include <optional>

#include <Eigen/Core>

#include "kinloop/optimize/linear/sparse_cholesky.hpp"

namespace kinloop {

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

}  // namespace kinloop
