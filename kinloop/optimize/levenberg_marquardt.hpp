#pragma once
// In: a least squares problem, a state to start from and how to damp. Out: the state at the nearest minimum
// that damped Gauss-Newton steps reach (Levenberg 1944, Marquardt 1963). The one loop that all built-in
// solvers share.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace kinloop {

/// Damping that changes by constant factors. Every step that does not raise the cost is taken.
struct FactorDamping {
  double value = 1e-5;  ///< relative to the diagonal of the normal equations
  double decrease_factor = 0.1;
  double increase_factor = 10;
  double min_value = 0;
  double max_value = std::numeric_limits<double>::infinity();  ///< from here on no step is tried

  /// Whether to take a step of that gain, which is how much it lowers the cost; never for NaN.
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

/// Nielsen's damping by the gain ratio, that of the decrease of the cost to the decrease that the linear
/// model predicts (Madsen et al. 2004, "Methods for non-linear least squares problems").
struct NielsenDamping {
  double value = 1e-4;  ///< relative to the diagonal of the normal equations
  double min_gain_ratio = 1e-4;
  int max_rejections = 20;  ///< of successive steps
  double growth = 2;        ///< at the next rejection
  int rejections = 0;       ///< of successive steps so far

  /// Whether to take a step of that gain ratio; never for NaN.
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

/// A step that was tried.
struct LevenbergMarquardtTrial {
  double cost = 0;       ///< before it
  double next_cost = 0;  ///< after it
  bool accepted = false;

  [[nodiscard]] double decrease() const { return cost - next_cost; }
};

struct LevenbergMarquardtLimits {
  int max_steps = std::numeric_limits<int>::max();           ///< tried, accepted or not
  int max_linearizations = std::numeric_limits<int>::max();  ///< one for each accepted step and the start
};

template <class State>
struct LevenbergMarquardtResult {
  State state;
  double cost = 0;
  int steps = 0;  ///< tried
  int linearizations = 0;
  bool converged = false;
};

/// Minimizes the cost of `problem` from `start`, which is given back where no step lowers it. The problem
/// provides
///   double cost(const State&);
///   void linearize(const State&);         // of the state whose cost was asked for last
///   std::optional<Step> solve(double);    // the step with that damping; nothing where the equations are
///   singular State apply(const State&, const Step&); double gain(const Step&, double decrease);       //
///   what the damping judges by bool is_negligible(const Step&, double cost);    // converged: not worth
///   being tried bool has_converged(const Step&, const LevenbergMarquardtTrial&);
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
