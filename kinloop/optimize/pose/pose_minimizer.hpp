#pragma once
// Minimization over a single pose, with or without its velocity, by dense normal equations of N unknowns.

#include <optional>

#include <Eigen/Cholesky>

#include "kinloop/optimize/levenberg_marquardt.hpp"

namespace kinloop {

/// Normal equations of the robust cost at one state; H symmetric.
template <int N>
struct PoseNormal {
  Eigen::Matrix<double, N, N> H = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> g = Eigen::Matrix<double, N, 1>::Zero();
  double cost = 0;
};

/// Problem of minimize_levenberg_marquardt that computes cost and normal equations together:
/// `linearize_at(state)` returns a PoseNormal<N>, `apply_step(state, step)` the updated state.
template <int N, class State, class LinearizeAt, class ApplyStep>
class PoseMinimizer {
 public:
  using Step = Eigen::Matrix<double, N, 1>;

  PoseMinimizer(const LinearizeAt& linearize_at, const ApplyStep& apply_step)
      : linearize_at_(linearize_at), apply_step_(apply_step) {}

  double cost(const State& state) {
    last_ = linearize_at_(state);
    return last_.cost;
  }
  void linearize(const State&) { normal_ = last_; }

  [[nodiscard]] std::optional<Step> solve(double damping) const {
    Eigen::Matrix<double, N, N> H = normal_.H;
    H.diagonal() *= 1 + damping;
    const Step step = -H.ldlt().solve(normal_.g);
    return step.allFinite() ? std::optional(step) : std::nullopt;
  }
  [[nodiscard]] State apply(const State& state, const Step& step) const { return apply_step_(state, step); }
  [[nodiscard]] double gain(const Step&, double decrease) const { return decrease; }
  [[nodiscard]] bool is_negligible(const Step&, double) const { return false; }
  [[nodiscard]] bool has_converged(const Step& step, const LevenbergMarquardtTrial& trial) const {
    return step.norm() < kMaxConvergedStep ||
           (trial.accepted && trial.decrease() < kMaxConvergedDecrease * trial.cost);
  }

 private:
  static constexpr double kMaxConvergedStep = 1e-7;  // m and rad, and their rates
  // Relative; far below the contribution of one among hundreds of observations.
  static constexpr double kMaxConvergedDecrease = 1e-6;

  const LinearizeAt& linearize_at_;
  const ApplyStep& apply_step_;
  PoseNormal<N> last_;    // at the state of the last call of cost()
  PoseNormal<N> normal_;  // at the state from which steps are tried
};

/// Returns the minimum near `start`, with at most `max_steps` steps.
template <int N, class State, class LinearizeAt, class ApplyStep>
State minimize_pose(const State& start, int max_steps, const LinearizeAt& linearize_at,
                    const ApplyStep& apply_step) {
  constexpr FactorDamping kDamping{.value = 1e-6, .decrease_factor = 0.1, .increase_factor = 100};
  PoseMinimizer<N, State, LinearizeAt, ApplyStep> problem(linearize_at, apply_step);
  return minimize_levenberg_marquardt(problem, start, kDamping, {.max_steps = max_steps}).state;
}

}  // namespace kinloop
