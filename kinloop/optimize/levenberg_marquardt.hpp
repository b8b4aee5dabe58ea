#pragma once
// Damped Gauss-Newton iteration to the nearest minimum of a least squares problem (Levenberg 1944, Marquardt
// 1963). All built-in solvers use this loop.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace kinloop {

/// Damping that changes by constant factors. Accepts every step that does not raise the cost.
struct FactorDamping {
  double value = 1e-5;  ///< relative to the diagonal of the normal equations
  double decrease_factor = 0.1;
  double increase_factor = 10;
  double min_value = 0;
  double max_value = std::numeric_limits<double>::infinity();  ///< stop when the damping reaches this value

  /// Returns whether to accept a step with this gain, the decrease of the cost; false for NaN.
  bool accept(double gain) {
    const bool accepted = gain >= 0;
    if (accepted) {
      value = std::max(min_value, value * decrease_factor);
    } else {
      increase();
    }
    return accepted;
  }
  void increase() { value *= increase_factor; }
  [[nodiscard]] bool is_exhausted() const { return value >= max_value; }
};

/// Nielsen's damping by the gain ratio: the decrease of the cost relative to the decrease predicted by the
/// linear model (Madsen et al. 2004, "Methods for non-linear least squares problems").
struct NielsenDamping {
  double value = 1e-4;  ///< relative to the diagonal of the normal equations
  double min_gain_ratio = 1e-4;
  int max_rejections = 20;  ///< maximum number of successive rejected steps
  double growth = 2;        ///< damping factor for the next rejection
  int rejections = 0;       ///< successive rejected steps so far

  /// Returns whether to accept a step with this gain ratio; false for NaN.
  bool accept(double gain_ratio) {
    if (!(gain_ratio > min_gain_ratio)) {
      increase();
      return false;
    }
    value *= std::max(1.0 / 3, 1 - std::pow(2 * gain_ratio - 1, 3));
    growth = 2;
    rejections = 0;
    return true;
  }
  void increase() {
    value *= growth;
    growth *= 2;
    ++rejections;
  }
  [[nodiscard]] bool is_exhausted() const { return rejections >= max_rejections; }
};

/// A trial step.
struct LevenbergMarquardtTrial {
  double cost = 0;       ///< before the step
  double next_cost = 0;  ///< after the step
  bool accepted = false;

  [[nodiscard]] double decrease() const { return cost - next_cost; }
};

struct LevenbergMarquardtLimits {
  int max_steps = std::numeric_limits<int>::max();           ///< number of trial steps, accepted or not
  int max_linearizations = std::numeric_limits<int>::max();  ///< one for the start and one per accepted step
};

template <class State>
struct LevenbergMarquardtResult {
  State state;
  double cost = 0;
  int steps = 0;  ///< trial steps
  int linearizations = 0;
  bool converged = false;
};

/// Minimizes the cost of `problem` from `start`. Returns `start` if no step lowers the cost. The problem
/// provides
///   double cost(const State&);
///   void linearize(const State&);       // at the state of the last call of cost()
///   std::optional<Step> solve(double);  // the step for this damping; nullopt if singular
///   State apply(const State&, const Step&);
///   double gain(const Step&, double decrease);        // gain or gain ratio, passed to the damping
///   bool is_negligible(const Step&, double cost);     // converged without trying the step
///   bool has_converged(const Step&, const LevenbergMarquardtTrial&);
template <class Problem, class State, class Damping>
LevenbergMarquardtResult<State> minimize_levenberg_marquardt(Problem& problem, State start, Damping damping,
                                                             const LevenbergMarquardtLimits& limits) {
  LevenbergMarquardtResult<State> at{std::move(start)};
  at.cost = problem.cost(at.state);
  bool is_linearized = false;
  while (at.steps < limits.max_steps && !damping.is_exhausted()) {
    if (!is_linearized) {
      if (at.linearizations >= limits.max_linearizations) break;
      problem.linearize(at.state);
      ++at.linearizations;
      is_linearized = true;
    }
    ++at.steps;
    const auto step = problem.solve(damping.value);
    if (!step) {
      damping.increase();
      continue;
    }
    at.converged = problem.is_negligible(*step, at.cost);
    if (at.converged) break;
    State next = problem.apply(at.state, *step);
    LevenbergMarquardtTrial trial{at.cost, problem.cost(next)};
    trial.accepted = damping.accept(problem.gain(*step, trial.decrease()));
    if (trial.accepted) {
      at.state = std::move(next);
      at.cost = trial.next_cost;
      is_linearized = false;
    }
    at.converged = problem.has_converged(*step, trial);
    if (at.converged) break;
  }
  return at;
}

}  // namespace kinloop
