#include <algorithm>

#include "kinloop/optimize/pose_graph/solvers/pose_graph_minimizer.hpp"

namespace kinloop {
namespace {

// Energy of the remaining error of conjugate gradients, relative to that of the solution.
constexpr double kEnergyTolerance = 1e-3;
// A block product within a factorisation needs B times the arithmetic of one within a solve, but no memory
// access latency.
constexpr double kProductsPerSolvedBlock = 4;
// A first step outside these lengths means that H has changed too much since it was factorised; 1 =
// unchanged.
constexpr double kMinFirstStep = 0.5, kMaxFirstStep = 2.0;

constexpr double kInitialNewtonDamping = 1e-10;
constexpr double kDampingGrowth = 100;
constexpr double kMaxDamping = 1e4;
constexpr double kMinScale = 1e-12;

}  // namespace

template <int B>
Eigen::VectorXd diagonal_scale(const BlockMatrix<B>& H) {
  Eigen::VectorXd scale(B * static_cast<Eigen::Index>(H.diagonal.size()));
  for (size_t i = 0; i < H.diagonal.size(); ++i) {
    scale.segment<B>(B * static_cast<Eigen::Index>(i)) = H.diagonal[i].diagonal();
  }
  const double smallest = kMinScale * scale.maxCoeff();
  return scale.cwiseMax(smallest > 0 ? smallest : 1.0);
}

template <int B>
NewtonSolver<B>::NewtonSolver(const BlockPattern& pattern, const EliminationPlan& plan)
    : pattern_(&pattern),
      cholesky_(plan),
      max_conjugate_steps_(
          1 + static_cast<int>(plan.factor_products / (kProductsPerSolvedBlock * plan.factor_blocks))) {}

template <int B>
std::optional<Eigen::VectorXd> NewtonSolver<B>::solve(const BlockMatrix<B>& H, const Eigen::VectorXd& b,
                                                      double negligible) {
  if (has_factor_) {
    if (auto d = solve_with_old_factor(H, b, negligible)) return d;
  }
  has_factor_ = cholesky_.factorize(H);
  if (has_factor_) {
    Eigen::VectorXd d = cholesky_.solve(b);
    if (d.allFinite()) return d;
    has_factor_ = false;
  }
  for (double damping = kInitialNewtonDamping; damping <= kMaxDamping; damping *= kDampingGrowth) {
    if (auto d = solve_damped(H, b, damping)) return d;
  }
  return {};
}

template <int B>
std::optional<Eigen::VectorXd> NewtonSolver<B>::solve_damped(BlockMatrix<B> H, const Eigen::VectorXd& b,
                                                             double damping) {
  const Eigen::VectorXd scale = diagonal_scale(H);
  for (size_t i = 0; i < H.diagonal.size(); ++i) {
    H.diagonal[i].diagonal() += damping * scale.segment<B>(B * static_cast<Eigen::Index>(i));
  }
  has_factor_ = false;
  if (!cholesky_.factorize(H)) return {};
  Eigen::VectorXd d = cholesky_.solve(b);
  if (!d.allFinite()) return {};
  return d;
}

template <int B>
std::optional<Eigen::VectorXd> NewtonSolver<B>::solve_with_old_factor(const BlockMatrix<B>& H,
                                                                      const Eigen::VectorXd& b,
                                                                      double negligible) const {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(b.size());
  Eigen::VectorXd residual = b;
  Eigen::VectorXd preconditioned = cholesky_.solve(residual);
  Eigen::VectorXd direction = preconditioned;
  double energy = residual.dot(preconditioned);
  if (energy <= negligible) return preconditioned;
  const double enough = std::max(kEnergyTolerance * energy, negligible);
  for (int step = 0; step < max_conjugate_steps_; ++step) {
    const Eigen::VectorXd product = multiply(*pattern_, H, direction);
    const double length = energy / direction.dot(product);
    if (!(length > 0)) return {};  // also for NaN
    if (step == 0 && (length < kMinFirstStep || length > kMaxFirstStep)) return {};
    d += length * direction;
    residual -= length * product;
    preconditioned = cholesky_.solve(residual);
    const double next_energy = residual.dot(preconditioned);
    if (next_energy <= enough) return d;
    direction = preconditioned + next_energy / energy * direction;
    energy = next_energy;
  }
  return {};
}

template class NewtonSolver<3>;
template class NewtonSolver<6>;
template Eigen::VectorXd diagonal_scale(const BlockMatrix<3>&);
template Eigen::VectorXd diagonal_scale(const BlockMatrix<6>&);

}  // namespace kinloop
