// Covariances of adjusted poses and of the sensor, compared with the inverse of the dense system assembled
// here from the residual Jacobians.

#include <limits>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/bundle/bundle_model.hpp"
#include "tests/optimize/bundle_world.hpp"

namespace kinloop {
namespace {

using test::BundleWorld;
using test::BundleWorldSettings;
using test::make_bundle_world;

/// H = J' J of poses (6 each), points (3 each) and the sensor, with one row per residual.
class DenseSystem {
 public:
  DenseSystem(const BundleProblem& problem, const BundleOptions& options, const BundleSolution& solution)
      : poses_(static_cast<Eigen::Index>(problem.T_world_camera.size())),
        points_(static_cast<Eigen::Index>(problem.p_world.size())),
        H_(Eigen::MatrixXd::Zero(sensor() + kSensorParameterCount, sensor() + kSensorParameterCount)) {
    const BundleTask task{problem, options, problem.fixed, problem.velocities, {}};
    const BundleState state{solution.T_world_camera, solution.p_world, solution.corrections};
    for (const BundleObservation& o : problem.observations) add(task, state, o);
    for (Eigen::Index i = 0; i < poses_; ++i) {
      if (problem.fixed[static_cast<size_t>(i)] != 0) hold(pose(i), 6);
    }
    for (int k = 0; k < kSensorParameterCount; ++k) {
      H_(sensor() + k, sensor() + k) += problem.prior.information(k);
      if (problem.prior.sigma(k) == 0) hold(sensor() + k, 1);
    }
  }

  /// Returns the inverse, scaled for mixed units; zero for constant parameters.
  [[nodiscard]] Eigen::MatrixXd covariance() const {
    const Eigen::VectorXd free = (H_.diagonal().array() < kHeld).cast<double>();
    const Eigen::VectorXd scale = H_.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * H_ * scale.asDiagonal();
    const Eigen::MatrixXd inverse = scaled.ldlt().solve(Eigen::MatrixXd::Identity(H_.rows(), H_.cols()));
    const Eigen::VectorXd back = scale.cwiseProduct(free);
    return back.asDiagonal() * inverse * back.asDiagonal();
  }

  [[nodiscard]] static Eigen::Index pose(Eigen::Index i) { return 6 * i; }
  [[nodiscard]] Eigen::Index sensor() const { return 6 * poses_ + 3 * points_; }

 private:
  static constexpr double kHeld = 1e30;

  [[nodiscard]] Eigen::Index point(Eigen::Index j) const { return 6 * poses_ + 3 * j; }

  void hold(Eigen::Index first, Eigen::Index count) {
    H_.middleRows(first, count).setZero();
    H_.middleCols(first, count).setZero();
    H_.diagonal().segment(first, count).setConstant(kHeld);
  }

  void add(const BundleTask& task, const BundleState& state, const BundleObservation& o) {
    const BundleUse use = o.depth_m > 0 ? BundleUse::kPixelAndDepth : BundleUse::kPixel;
    const auto linear = linearize_observation(sensor_at(task, state), o, use,
                                              {state.T_world_camera[o.pose], task.velocities[o.pose]},
                                              state.p_world[o.point]);
    const HuberLoss loss{task.problem.sensor.noise.robust_width};
    const double pixel_weight = loss.weight(linear.e.head<2>().squaredNorm());
    const Eigen::Vector3d weight(pixel_weight, pixel_weight, loss.weight(linear.e.z() * linear.e.z()));
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, H_.cols());
    J.middleCols<6>(pose(o.pose)) = linear.J_pose;
    J.middleCols<3>(point(o.point)) = linear.J_point;
    J.rightCols<kSensorParameterCount>() = linear.J_sensor;
    H_ += J.transpose() * weight.asDiagonal() * J;
  }

  Eigen::Index poses_, points_;
  Eigen::MatrixXd H_;
};

/// A small world in which everything is well observed, with the sensor free.
BundleWorld free_world(int points = 60) {
  BundleWorldSettings settings{
      .poses = 7, .points = points, .sigma_px = 0.7, .sigma_inverse_depth = 2e-3, .depth_fraction = 1};
  settings.sensor(kRollingShutter) = 0.02;
  settings.sensor(kDepthDelay) = 0.01;
  BundleWorld world = make_bundle_world(settings);
  for (const int k : {kRollingShutter, kDepthDelay}) {
    world.problem.prior.sigma(k) = SensorPrior::kUnknown;
  }
  world.problem.prior.sigma(kFocalX) = 3;
  world.problem.prior.sigma(kInverseDepthBias) = 0.002;
  NoiseModel& noise = world.problem.sensor.noise;
  noise.keypoint.coefficient_per_m = 2e-3;
  noise.inlier_chi2_pixel = noise.inlier_chi2_depth = 1e12;  // no outliers
  // Points without observations would be empty columns of the dense system.
  std::vector<uint32_t> index(world.points.size(), 0);
  std::vector<Eigen::Vector3d> seen;
  for (auto& o : world.problem.observations) {
    if (index[o.point] == 0) {
      seen.push_back(world.points[o.point]);
      index[o.point] = static_cast<uint32_t>(seen.size());
    }
    o.point = index[o.point] - 1;
  }
  world.problem.p_world = world.points = seen;
  return world;
}

BundleOptions with_covariances() {
  BundleOptions options;
  options.max_iterations = 30;
  options.pose_covariances = true;
  return options;
}

/// Relative to the standard deviations of rows and columns.
double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(BundleCovariance, MatchesTheDenseSystem) {
  const BundleWorld world = free_world();
  for (const auto solver : {BundleSolver::kBuiltin, BundleSolver::kCeres}) {
    BundleOptions options = with_covariances();
    options.solver = solver;
    const BundleSolution solution = solve_bundle(world.problem, options);
    ASSERT_EQ(solution.point_used.size(), world.problem.p_world.size());
    ASSERT_THAT(solution.point_used, testing::Each(1));
    const DenseSystem system(world.problem, options, solution);
    const Eigen::MatrixXd covariance = system.covariance();
    EXPECT_EQ(solution.pose_covariance[0], Matrix6d::Zero()) << "constant";
    for (size_t i = 1; i < world.truth.size(); ++i) {
      const Eigen::Index first = DenseSystem::pose(static_cast<Eigen::Index>(i));
      EXPECT_LT(difference(solution.pose_covariance[i], covariance.block<6, 6>(first, first)), 1e-6) << i;
    }
    for (const int a : {kRollingShutter, kDepthDelay, kFocalX, kInverseDepthBias}) {
      for (const int b : {kRollingShutter, kDepthDelay, kFocalX, kInverseDepthBias}) {
        const Eigen::Index s = system.sensor();
        const double scale = std::sqrt(covariance(s + a, s + a) * covariance(s + b, s + b));
        EXPECT_NEAR(solution.sensor_covariance(a, b) / scale, covariance(s + a, s + b) / scale, 1e-6);
      }
    }
  }
}

TEST(BundleCovariance, FreeParametersIncreasePoseCovariance) {
  BundleWorld world = free_world();
  BundleOptions options = with_covariances();
  // Start at the truth, so that every run finds nearly the same minimum.
  world.problem.sensor.corrections(kRollingShutter) = 0.02;
  world.problem.sensor.corrections(kDepthDelay) = 0.01;
  world.problem.sensor.noise.robust_width = 1e9;  // all weights are one
  const Matrix6d sensor_free = solve_bundle(world.problem, options).pose_covariance[6];
  world.problem.prior.sigma.setZero();
  const Matrix6d all_held = solve_bundle(world.problem, options).pose_covariance[6];
  EXPECT_GT(sensor_free.trace(), 1.01 * all_held.trace());
}

TEST(BundleCovariance, ResidualVarianceIsThatOfTheNoise) {
  BundleWorld world = free_world();
  const double as_made = solve_bundle(world.problem, with_covariances()).residual_variance;
  for (BundleObservation& o : world.problem.observations) o.sigma_px /= 2;
  world.problem.sensor.noise.keypoint.coefficient_per_m /= 2;
  const double half_assumed = solve_bundle(world.problem, with_covariances()).residual_variance;
  // The residuals of Huber's estimate are a little larger than those of least squares.
  EXPECT_NEAR(as_made, 1, 0.15);
  EXPECT_NEAR(half_assumed / as_made, 4, 0.2);
}

TEST(BundleCovariance, ResidualsThatShareAnErrorAreClustered) {
  BundleWorld world = free_world(1000);
  EXPECT_NEAR(solve_bundle(world.problem, with_covariances()).residual_clustering, 1, 0.2);
  // Bends every second image the other way, which neither poses nor points do.
  for (BundleObservation& o : world.problem.observations)
    o.pixel.x() += (o.pose % 2 == 0) == (o.pixel.y() > 240) ? 1 : -1;
  EXPECT_GT(solve_bundle(world.problem, with_covariances()).residual_clustering, 1.5);
}

TEST(BundleCovariance, UnobservedPosesHaveInfiniteCovariance) {
  BundleWorld world = free_world();
  auto& observations = world.problem.observations;
  std::erase_if(observations, [](const BundleObservation& o) { return o.pose == 3; });
  size_t kept = 0;  // pose 4 observes only one point: singular up to rounding
  std::erase_if(observations, [&](const BundleObservation& o) { return o.pose == 4 && kept++ > 0; });
  const BundleSolution solution = solve_bundle(world.problem, with_covariances());
  const Eigen::MatrixXd unseen = solution.pose_covariance[3];
  EXPECT_THAT(unseen.diagonal(), testing::Each(std::numeric_limits<double>::infinity()));
  EXPECT_GT(solution.pose_covariance[4].diagonal().maxCoeff(), 1.0) << "rad^2 or m^2";
  for (const size_t i : {1, 2, 5, 6}) {
    EXPECT_GT(solution.pose_covariance[i].diagonal().minCoeff(), 0) << i;
    EXPECT_LT(solution.pose_covariance[i].diagonal().maxCoeff(), 0.01) << i;
  }
}

TEST(BundleCovariance, IsNotComputedUnlessRequested) {
  BundleOptions options = with_covariances();
  options.pose_covariances = false;
  const BundleSolution solution = solve_bundle(free_world().problem, options);
  EXPECT_TRUE(solution.pose_covariance.empty());
  EXPECT_EQ(solution.residual_variance, 0);
  EXPECT_GT(solution.sensor_covariance(kDepthDelay, kDepthDelay), 0) << "computed for every free parameter";
}

}  // namespace
}  // namespace kinloop
