// Bundle adjustment by Levenberg-Marquardt on the Schur complement.

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinloop/optimize/bundle/bundle_schur.hpp"
#include "kinloop/optimize/levenberg_marquardt.hpp"

namespace kinloop {
namespace {

constexpr double kSelectionDamping = 1e-9;  // the state is close to the minimum

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
    return std::abs(trial.decrease()) <= task_.tolerance * cost;
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

BundleSelection select_sensor_parameters(const BundleTask& task, const BundleState& state) {
  BundleSchur schur(task);
  schur.linearize(state);
  BundleSelection selection{schur.covariance().sensor, task.prior, state};
  SensorVector held_steps = SensorVector::Constant(std::numeric_limits<double>::quiet_NaN());
  for (const int k : task.prior.free_parameters()) {
    const double sigma = std::sqrt(std::max(selection.covariance(k, k), 0.0));
    if (task.prior.accepts(k, state.corrections(k), sigma)) continue;
    held_steps(k) = task.prior.mean(k) - state.corrections(k);
    selection.prior.sigma(k) = 0;
    selection.state.corrections(k) = task.prior.mean(k);
  }
  const auto step = schur.solve(kSelectionDamping, held_steps);
  if (!step) return selection;
  BundleState stepped = schur.apply(state, *step);
  for (const int k : task.prior.free_parameters()) {
    if (selection.prior.sigma(k) == 0) stepped.corrections(k) = task.prior.mean(k);
  }
  if (bundle_cost(task, stepped) < bundle_cost(task, selection.state)) selection.state = std::move(stepped);
  return selection;
}

BundleCovariance bundle_covariance(const BundleTask& task, const BundleState& state) {
  BundleSchur schur(task);
  schur.linearize(state);
  return schur.covariance();
}

}  // namespace kinloop
