#include "kinloop/optimize/pose_graph/solvers/pose_graph_minimizer.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/optimize/levenberg_marquardt.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_solvers.hpp"

namespace kinloop {
namespace {

constexpr double kNegligibleChi2 = 1e-12;  // a smaller cost is zero except for rounding
constexpr double kMinGainRatio = 1e-4;     // ratio of actual to predicted decrease of the cost
constexpr double kGoodGainRatio = 0.75, kPoorGainRatio = 0.25;
constexpr double kRadiusGrowth = 3.0, kRadiusCut = 0.3;
constexpr double kWatchdogRise = 10;  // maximum relative rise of the cost before the second watchdog step
constexpr int kMaxTrials = 20;        // step reductions before giving up

/// Minimum predicted decrease for a step to be tried.
double negligible_decrease(double cost) {
  return std::max(kCostTolerance * cost, kNegligibleChi2);
}

/// Predictions of the linear model for a step.
template <class Pose>
double predicted_decrease(const PoseGraphLayout& layout, const PoseGraphSystem<Pose>& system,
                          const Eigen::VectorXd& d) {
  return 2 * system.minus_g.dot(d) - d.dot(multiply(layout.pattern, system.H, d));
}

/// Adapter of a pose graph for minimize_levenberg_marquardt.
template <class Pose>
class LevenbergPoseGraph {
 public:
  using Poses = std::vector<Pose>;

  LevenbergPoseGraph(const MinimizerProblem<Pose>& problem, const PoseGraphKernel& kernel,
                     NewtonSolver<Pose::kDof>& newton)
      : problem_(problem), kernel_(kernel), newton_(newton), system_(problem.layout.pattern) {}

  [[nodiscard]] double cost(const Poses& poses) const { return robust_cost(problem_.graph, kernel_, poses); }
  void linearize(const Poses& poses) {
    kinloop::linearize(problem_.graph, problem_.layout, kernel_, poses, system_);
  }
  std::optional<Eigen::VectorXd> solve(double damping) {
    return newton_.solve_damped(system_.H, system_.minus_g, damping);
  }
  [[nodiscard]] Poses apply(const Poses& poses, const Eigen::VectorXd& d) const {
    return apply_step(poses, problem_.layout, d);
  }
  [[nodiscard]] double gain(const Eigen::VectorXd& d, double decrease) const {
    const double ratio = decrease / predicted_decrease(problem_.layout, system_, d);
    return std::isfinite(ratio) ? ratio : 0;
  }
  [[nodiscard]] bool is_negligible(const Eigen::VectorXd& d, double cost) const {
    return predicted_decrease(problem_.layout, system_, d) <= negligible_decrease(cost);
  }
  [[nodiscard]] bool has_converged(const Eigen::VectorXd&, const LevenbergMarquardtTrial&) const {
    return false;
  }

 private:
  const MinimizerProblem<Pose>& problem_;
  const PoseGraphKernel& kernel_;
  NewtonSolver<Pose::kDof>& newton_;
  PoseGraphSystem<Pose> system_;
};

/// One minimization; the three methods differ in step selection.
template <class Pose>
class PoseGraphMinimizer {
 public:
  PoseGraphMinimizer(const MinimizerProblem<Pose>& problem, const PoseGraphKernel& kernel,
                     MinimizerState<Pose> from, NewtonSolver<Pose::kDof>& newton)
      : problem_(problem),
        kernel_(kernel),
        at_(std::move(from)),
        newton_(newton),
        system_(problem.layout.pattern) {
    at_.converged = false;
  }

  MinimizerState<Pose> run() {
    if (problem_.method == PoseGraphMethod::kLevenberg) return levenberg();
    at_.cost = robust_cost(problem_.graph, kernel_, at_.T_world_vertex);
    while (!at_.converged && at_.iterations < problem_.max_iterations) {
      linearize(problem_.graph, problem_.layout, kernel_, at_.T_world_vertex, system_);
      ++at_.iterations;
      const bool step_taken =
          problem_.method == PoseGraphMethod::kGaussNewton ? gauss_newton_step() : dogleg_step();
      if (!step_taken) break;
    }
    return std::move(at_);
  }

 private:
  [[nodiscard]] double negligible_decrease() const { return kinloop::negligible_decrease(at_.cost); }

  [[nodiscard]] double predicted_decrease(const Eigen::VectorXd& d) const {
    return kinloop::predicted_decrease(problem_.layout, system_, d);
  }

  struct Trial {
    MinimizerState<Pose> to;
    double gain_ratio;
  };

  [[nodiscard]] Trial attempt(const Eigen::VectorXd& d) const {
    Trial trial{{apply_step(at_.T_world_vertex, problem_.layout, d), 0, at_.iterations, false}, 0};
    trial.to.cost = robust_cost(problem_.graph, kernel_, trial.to.T_world_vertex);
    trial.gain_ratio = (at_.cost - trial.to.cost) / predicted_decrease(d);
    if (!std::isfinite(trial.gain_ratio)) trial.gain_ratio = 0;
    return trial;
  }

  bool gauss_newton_step() {
    const auto d = newton_.solve(system_.H, system_.minus_g, negligible_decrease());
    if (!d) return false;
    if (predicted_decrease(*d) <= negligible_decrease()) return at_.converged = true;
    Trial trial = attempt(*d);
    if (!std::isfinite(trial.to.cost)) return false;
    at_ = std::move(trial.to);
    return true;
  }

  MinimizerState<Pose> levenberg() {
    LevenbergPoseGraph<Pose> problem(problem_, kernel_, newton_);
    const LevenbergMarquardtLimits limits{.max_linearizations = problem_.max_iterations - at_.iterations};
    auto found = minimize_levenberg_marquardt(problem, std::move(at_.T_world_vertex),
                                              NielsenDamping{.min_gain_ratio = kMinGainRatio}, limits);
    return {std::move(found.state), found.cost, at_.iterations + found.linearizations, found.converged};
  }

  /// Powell's dogleg (Nocedal and Wright 2006, section 4.1), lengths in units of the diagonal of H.
  bool dogleg_step() {
    const auto newton = newton_.solve(system_.H, system_.minus_g, negligible_decrease());
    if (!newton) return false;
    if (predicted_decrease(*newton) <= negligible_decrease()) return at_.converged = true;
    const Eigen::VectorXd scale = diagonal_scale(system_.H).cwiseSqrt();
    const double newton_length = newton->cwiseProduct(scale).norm();
    for (int i = 0; i < kMaxTrials; ++i) {
      const Eigen::VectorXd d = within_radius(*newton, scale);
      const double length = d.cwiseProduct(scale).norm();
      Trial trial = attempt(d);
      if (trial.gain_ratio < kPoorGainRatio) radius_ = kRadiusCut * length;
      if (trial.gain_ratio > kGoodGainRatio) radius_ = std::max(radius_, kRadiusGrowth * length);
      if (trial.gain_ratio > kMinGainRatio) {
        const double decrease = at_.cost - trial.to.cost;
        at_ = std::move(trial.to);
        // Newton steps decrease at least by a constant factor, so the next one is negligible.
        at_.converged =
            length >= newton_length && decrease * decrease <= negligible_decrease() * last_decrease_;
        last_decrease_ = decrease;
        return true;
      }
      if (i == 0 && length >= newton_length && watchdog_step(trial.to)) return true;
    }
    return at_.converged = true;  // no step this short lowers the cost beyond rounding
  }

  /// Newton's step often overshoots along a curved valley, and the next one falls below the starting cost
  /// (the watchdog of Chamberlain et al. 1982). Takes both steps if so.
  bool watchdog_step(const MinimizerState<Pose>& overshot) {
    if (!(overshot.cost < kWatchdogRise * at_.cost) || at_.iterations >= problem_.max_iterations)
      return false;
    PoseGraphSystem<Pose> there(problem_.layout.pattern);
    linearize(problem_.graph, problem_.layout, kernel_, overshot.T_world_vertex, there);
    const auto d = newton_.solve(there.H, there.minus_g, negligible_decrease());
    if (!d) return false;
    MinimizerState<Pose> second{apply_step(overshot.T_world_vertex, problem_.layout, *d), 0,
                                at_.iterations + 1, false};
    second.cost = robust_cost(problem_.graph, kernel_, second.T_world_vertex);
    if (!(second.cost < at_.cost)) return false;
    at_ = std::move(second);
    radius_ = std::numeric_limits<double>::infinity();
    return true;
  }

  /// Returns the step within the trust region: Newton's, steepest descent, or a combination.
  [[nodiscard]] Eigen::VectorXd within_radius(const Eigen::VectorXd& newton,
                                              const Eigen::VectorXd& scale) const {
    const Eigen::VectorXd to_newton = newton.cwiseProduct(scale);
    if (to_newton.norm() <= radius_) return newton;
    const Eigen::VectorXd descent = system_.minus_g.cwiseQuotient(scale);
    const Eigen::VectorXd unscaled = descent.cwiseQuotient(scale);
    const double curvature = unscaled.dot(multiply(problem_.layout.pattern, system_.H, unscaled));
    const Eigen::VectorXd cauchy = descent.squaredNorm() / curvature * descent;
    if (!(cauchy.norm() < radius_)) return (radius_ / descent.norm() * descent).cwiseQuotient(scale);
    // |cauchy + s (newton - cauchy)| = radius
    const Eigen::VectorXd leg = to_newton - cauchy;
    const double a = leg.squaredNorm(), b = cauchy.dot(leg), c = radius_ * radius_ - cauchy.squaredNorm();
    const double s = c / (b + std::sqrt(b * b + a * c));
    return (cauchy + s * leg).cwiseQuotient(scale);
  }

  const MinimizerProblem<Pose>& problem_;
  const PoseGraphKernel kernel_;
  MinimizerState<Pose> at_;
  NewtonSolver<Pose::kDof>& newton_;
  PoseGraphSystem<Pose> system_;
  double radius_ = std::numeric_limits<double>::infinity();
  double last_decrease_ = 0;  ///< of the cost in the last step
};

}  // namespace

template <class Pose>
MinimizerState<Pose> minimize_pose_graph(const MinimizerProblem<Pose>& problem, const PoseGraphKernel& kernel,
                                         MinimizerState<Pose> from, NewtonSolver<Pose::kDof>& newton) {
  return PoseGraphMinimizer<Pose>(problem, kernel, std::move(from), newton).run();
}

template MinimizerState<SE3> minimize_pose_graph(const MinimizerProblem<SE3>&, const PoseGraphKernel&,
                                                 MinimizerState<SE3>, NewtonSolver<SE3::kDof>&);
template MinimizerState<SE2> minimize_pose_graph(const MinimizerProblem<SE2>&, const PoseGraphKernel&,
                                                 MinimizerState<SE2>, NewtonSolver<SE2::kDof>&);

}  // namespace kinloop
