// Bundle adjustment by Levenberg-Marquardt on the Schur complement.

#include <cmath>

#include "kinloop/optimize/bundle/bundle_schur.hpp"
#include "kinloop/optimize/levenberg_marquardt.hpp"

namespace kinloop {
namespace {

/// Adapter of bundle adjustment for minimize_levenberg_marquardt.
class BundleMinimizer {
 public:
  explicit BundleMinimizer(const BundleTask& task) : task_(task), schur_(task) {}

  [[nodiscard]] double cost(const BundleState& state) const { return bundle_cost(task_, state); }
  void linearize(const BundleState& state) { schur_.linearize(state); }
  std::optional<BundleStep> solve(double damping) { return schur_.solve(damping); }
  [[nodiscard]] BundleState apply(const BundleState& state, const BundleStep& step) const {
    return schur_.apply(state, step);
  }
  [[nodiscard]] double gain(const BundleStep&, double decrease) const { return decrease; }
  [[nodiscard]] bool is_negligible(const BundleStep&, double) const { return false; }
  [[nodiscard]] bool has_converged(const BundleStep&, const LevenbergMarquardtTrial& trial) const {
    const double cost = trial.accepted ? trial.next_cost : trial.cost;
    return std::abs(trial.decrease()) <= task_.options.tolerance * cost;
  }

 private:
  const BundleTask& task_;
  BundleSchur schur_;
};

}  // namespace

BundleRoundResult minimize_builtin(const BundleTask& task, const BundleState& start) {
  constexpr FactorDamping kDamping{.value = 1e-5, .min_value = 1e-10, .max_value = 1e8};
  BundleMinimizer problem(task);
  auto result =
      minimize_levenberg_marquardt(problem, start, kDamping, {.max_steps = task.options.max_iterations});
  return {std::move(result.state), result.steps, result.converged};
}

BundleCovariance bundle_covariance(const BundleTask& task, const BundleState& state) {
  BundleSchur schur(task);
  schur.linearize(state);
  return schur.covariance();
}

}  // namespace kinloop
