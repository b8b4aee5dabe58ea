// Bundle adjustment by Levenberg and Marquardt on the Schur complement.

#include "kinloop/optimize/bundle/bundle_schur.hpp"

namespace kinloop {
namespace {

constexpr double kFirstDamping = 1e-5;  // relative to the diagonal
constexpr double kMinDamping = 1e-10;
constexpr double kMaxDamping = 1e8;
constexpr double kDampingDecrease = 0.1,
                 kDampingIncrease = 10;  // change of damping after a good and after a bad step

template <int C>
BundleRoundResult minimize(const BundleTask& task, const BundleState& start) {
  BundleRoundResult round{start, 0, false};
  BundleSchur<C> schur(task);
  double cost = bundle_cost(task, start);
  double damping = kFirstDamping;
  bool stale = true;  // the linearisation is of another state
  while (round.iterations < task.options.max_iterations && damping < kMaxDamping) {
    ++round.iterations;
    if (stale) schur.linearize(round.state);
    stale = false;
    const auto step = schur.solve(damping);
    if (!step) {
      damping *= kDampingIncrease;
      continue;
    }
    BundleState next = schur.apply(round.state, *step);
    const double next_cost = bundle_cost(task, next);
    const double decrease = cost - next_cost;
    if (decrease >= 0) {  // not for NaN
      round.state = std::move(next);
      cost = next_cost;
      stale = true;
      damping = std::max(kMinDamping, damping * kDampingDecrease);
    } else {
      damping *= kDampingIncrease;
    }
    if (std::abs(decrease) <= task.options.tolerance * cost) {
      round.converged = true;
      break;
    }
  }
  return round;
}

template <int C>
BundleCovariance covariance_of(const BundleTask& task, const BundleState& state) {
  BundleSchur<C> schur(task);
  schur.linearize(state);
  return schur.covariance();
}

}  // namespace

BundleRoundResult minimize_builtin(const BundleTask& task, const BundleState& state) {
  return task.options.free_velocities ? minimize<12>(task, state) : minimize<6>(task, state);
}

BundleCovariance bundle_covariance(const BundleTask& task, const BundleState& state) {
  return task.options.free_velocities ? covariance_of<12>(task, state) : covariance_of<6>(task, state);
}

}  // namespace kinloop
