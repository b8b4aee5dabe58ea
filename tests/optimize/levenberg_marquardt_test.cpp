#include "kinloop/optimize/levenberg_marquardt.hpp"

#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace kinloop {
namespace {

/// Two unknowns with two residuals; counts its calls.
class SmallProblem {
 public:
  virtual ~SmallProblem() = default;

  double cost(const Eigen::Vector2d& x) {
    last_ = x;
    ++costs;
    return residuals(x).squaredNorm();
  }
  void linearize(const Eigen::Vector2d& x) {
    EXPECT_EQ(x, last_) << "linearized at the state of the last cost evaluation";
    const Eigen::Matrix2d J = jacobian(x);
    H_ = J.transpose() * J;
    g_ = J.transpose() * residuals(x);
    ++linearizations;
  }
  std::optional<Eigen::Vector2d> solve(double damping) {
    dampings.push_back(damping);
    if (is_singular) return std::nullopt;
    Eigen::Matrix2d H = H_;
    H.diagonal() *= 1 + damping;
    return Eigen::Vector2d(-H.ldlt().solve(g_));
  }
  static Eigen::Vector2d apply(const Eigen::Vector2d& x, const Eigen::Vector2d& step) { return x + step; }
  double gain(const Eigen::Vector2d& step, double decrease) const {
    return use_gain_ratio ? decrease / (-2 * g_.dot(step) - step.dot(H_ * step)) : decrease;
  }
  bool is_negligible(const Eigen::Vector2d& step, double) const { return step.norm() < 1e-12; }
  static bool has_converged(const Eigen::Vector2d&, const LevenbergMarquardtTrial& trial) {
    EXPECT_TRUE(!trial.accepted || trial.next_cost <= trial.cost);
    return false;
  }

  bool is_singular = false, use_gain_ratio = false;
  int costs = 0, linearizations = 0;
  std::vector<double> dampings;

 private:
  [[nodiscard]] virtual Eigen::Vector2d residuals(const Eigen::Vector2d& x) const = 0;
  [[nodiscard]] virtual Eigen::Matrix2d jacobian(const Eigen::Vector2d& x) const = 0;

  Eigen::Vector2d last_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d H_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g_ = Eigen::Vector2d::Zero();
};

class LinearProblem : public SmallProblem {
  [[nodiscard]] Eigen::Vector2d residuals(const Eigen::Vector2d& x) const override {
    return {x.x() + 2 * x.y() - 4, 3 * x.x() - x.y() - 5};
  }
  [[nodiscard]] Eigen::Matrix2d jacobian(const Eigen::Vector2d&) const override {
    return (Eigen::Matrix2d() << 1, 2, 3, -1).finished();
  }
};

/// Rosenbrock's function: the first Gauss-Newton step overshoots by far.
class RosenbrockProblem : public SmallProblem {
  [[nodiscard]] Eigen::Vector2d residuals(const Eigen::Vector2d& x) const override {
    return {10 * (x.y() - x.x() * x.x()), 1 - x.x()};
  }
  [[nodiscard]] Eigen::Matrix2d jacobian(const Eigen::Vector2d& x) const override {
    return (Eigen::Matrix2d() << -20 * x.x(), 10, -1, 0).finished();
  }
};

/// Derivatives of the wrong sign: every step raises the cost.
class UphillProblem : public SmallProblem {
  [[nodiscard]] Eigen::Vector2d residuals(const Eigen::Vector2d& x) const override { return x; }
  [[nodiscard]] Eigen::Matrix2d jacobian(const Eigen::Vector2d&) const override {
    return -Eigen::Matrix2d::Identity();
  }
};

TEST(LevenbergMarquardt, SolvesALinearProblemInOneUndampedStep) {
  LinearProblem problem;
  const auto result = minimize_levenberg_marquardt(problem, Eigen::Vector2d(100, -50),
                                                   FactorDamping{.value = 0}, {.max_steps = 1});
  EXPECT_LT((result.state - Eigen::Vector2d(2, 1)).norm(), 1e-12);
  EXPECT_LT(result.cost, 1e-20);
  EXPECT_FALSE(result.converged) << "convergence is detected by the next step";
}

TEST(LevenbergMarquardt, MinimizesRosenbrocksFunctionWithEitherDamping) {
  RosenbrockProblem by_factor, by_ratio;
  by_ratio.use_gain_ratio = true;
  const auto factor =
      minimize_levenberg_marquardt(by_factor, Eigen::Vector2d(-1.2, 1), FactorDamping{}, {.max_steps = 100});
  const auto nielsen =
      minimize_levenberg_marquardt(by_ratio, Eigen::Vector2d(-1.2, 1), NielsenDamping{}, {.max_steps = 100});
  for (const auto& result : {factor, nielsen}) {
    EXPECT_TRUE(result.converged);
    EXPECT_LT((result.state - Eigen::Vector2d(1, 1)).norm(), 1e-8);
    EXPECT_GT(result.steps, result.linearizations) << "some steps were rejected";
  }
}

TEST(LevenbergMarquardt, RejectsStepsThatRaiseTheCost) {
  UphillProblem problem;
  const auto result = minimize_levenberg_marquardt(
      problem, Eigen::Vector2d(3, 4), FactorDamping{.value = 1, .increase_factor = 10}, {.max_steps = 4});
  EXPECT_EQ(result.state, Eigen::Vector2d(3, 4));
  EXPECT_EQ(result.cost, 25);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.steps, 4);
  EXPECT_EQ(problem.linearizations, 1) << "no new linearization until a step is accepted";
  EXPECT_EQ(problem.dampings, std::vector<double>({1, 10, 100, 1000}));
}

TEST(LevenbergMarquardt, AcceptedStepsLowerTheDampingToItsMinimum) {
  LinearProblem problem;
  minimize_levenberg_marquardt(problem, Eigen::Vector2d(9, 9), FactorDamping{.value = 1, .min_value = 0.05},
                               {.max_steps = 4});
  EXPECT_EQ(problem.dampings, std::vector<double>({1, 0.1, 0.05, 0.05}));
}

TEST(LevenbergMarquardt, StopsIfTheEquationsStaySingular) {
  LinearProblem by_factor, by_ratio;
  by_factor.is_singular = by_ratio.is_singular = true;
  const auto factor = minimize_levenberg_marquardt(by_factor, Eigen::Vector2d(1, 2),
                                                   FactorDamping{.value = 1, .max_value = 1e4}, {});
  EXPECT_EQ(factor.state, Eigen::Vector2d(1, 2));
  EXPECT_EQ(factor.steps, 4);
  EXPECT_FALSE(factor.converged);
  EXPECT_EQ(by_factor.costs, 1) << "no step to try";
  const auto nielsen =
      minimize_levenberg_marquardt(by_ratio, Eigen::Vector2d(1, 2), NielsenDamping{.max_rejections = 7}, {});
  EXPECT_EQ(nielsen.steps, 7);
  EXPECT_FALSE(nielsen.converged);
}

TEST(LevenbergMarquardt, RespectsItsLimits) {
  RosenbrockProblem problem;
  const auto result = minimize_levenberg_marquardt(problem, Eigen::Vector2d(-1.2, 1), FactorDamping{},
                                                   {.max_linearizations = 3});
  EXPECT_EQ(result.linearizations, 3);
  EXPECT_EQ(problem.linearizations, 3);
  RosenbrockProblem untouched;
  const auto none =
      minimize_levenberg_marquardt(untouched, Eigen::Vector2d(-1.2, 1), FactorDamping{}, {.max_steps = 0});
  EXPECT_EQ(none.state, Eigen::Vector2d(-1.2, 1));
  EXPECT_DOUBLE_EQ(none.cost, 24.2);
}

}  // namespace
}  // namespace kinloop
