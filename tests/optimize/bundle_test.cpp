#include "kinloop/optimize/bundle/bundle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/optimize/bundle_world.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using test::BundleWorld;
using test::BundleWorldSettings;
using test::kNan;
using test::make_bundle_world;
using test::perturb;
using test::position_error_m;

BundleOptions thorough() {
  BundleOptions options;
  options.max_iterations = 50;
  options.tolerance = 1e-12;
  return options;
}

TEST(Bundle, RecoversAnIdealWorld) {
  for (const auto solver : {BundleSolver::kBuiltin, BundleSolver::kCeres}) {
    BundleWorld world = make_bundle_world({});
    perturb(world, 0.03, 0.02);
    BundleOptions options = thorough();
    options.solver = solver;
    const BundleSolution solution = solve_bundle(world.problem, options);
    EXPECT_LT(position_error_m(solution.T_world_camera, world.truth), 1e-7) << name_of(solver);
    size_t used = 0;
    for (size_t i = 0; i < world.points.size(); ++i) {
      if (solution.point_used[i] == 0) continue;
      ++used;
      EXPECT_LT((solution.p_world[i] - world.points[i]).norm(), 1e-6);
    }
    EXPECT_GT(used, world.points.size() / 3);
    EXPECT_LT(solution.chi2_after, 1e-8 * solution.chi2_before);
    EXPECT_EQ(solution.outliers.size(), world.problem.observations.size());
    EXPECT_THAT(solution.outliers, testing::Each(0));
  }
}

TEST(Bundle, PixelsAloneAreEnoughIfScaleIsFixed) {
  BundleWorld world = make_bundle_world({.depth_fraction = 0});
  world.problem.fixed[5] = 1;
  perturb(world, 0.02, 0.01);
  const BundleSolution solution = solve_bundle(world.problem, thorough());
  EXPECT_LT(position_error_m(solution.T_world_camera, world.truth), 1e-6);
}

TEST(Bundle, FixedPosesDoNotMove) {
  BundleWorld world = make_bundle_world({.sigma_px = 1, .sigma_inverse_depth = 2e-3});
  world.problem.fixed[4] = 1;
  perturb(world, 0.01, 0.01);
  const BundleSolution solution = solve_bundle(world.problem, {});
  for (const size_t i : {0, 4}) {
    EXPECT_EQ(solution.T_world_camera[i].translation, world.truth[i].translation);
    EXPECT_EQ(solution.T_world_camera[i].rotation.coeffs(), world.truth[i].rotation.coeffs());
  }
}

TEST(Bundle, BuiltinAndCeresAgree) {
  BundleWorldSettings settings{
      .poses = 10, .points = 150, .sigma_px = 0.8, .sigma_inverse_depth = 2e-3, .outlier_fraction = 0.03};
  settings.sensor(kRollingShutter) = 0.03;
  settings.sensor(kDepthDelay) = 0.015;
  settings.sensor(kFocalX) = 3;
  BundleWorld world = make_bundle_world(settings);
  perturb(world, 0.02, 0.01);
  world.problem.prior.sigma(kRollingShutter) = SensorPrior::kUnknown;
  world.problem.prior.sigma(kDepthDelay) = SensorPrior::kUnknown;
  world.problem.prior.sigma(kFocalX) = 5;
  BundleOptions options = thorough();
  options.rounds = 1;
  options.max_iterations = 200;
  options.tolerance = 1e-15;  // converge fully: the focal length converges last
  NoiseModel& noise = world.problem.sensor.noise;
  noise.inlier_chi2_pixel = noise.inlier_chi2_depth = 1e12;  // no outliers: one minimum of one cost
  const BundleSolution builtin = solve_bundle(world.problem, options);
  options.solver = BundleSolver::kCeres;
  const BundleSolution ceres = solve_bundle(world.problem, options);
  EXPECT_NEAR(builtin.chi2_after / ceres.chi2_after, 1.0, 1e-8);
  EXPECT_LT(position_error_m(builtin.T_world_camera, ceres.T_world_camera), 1e-6);
  for (int i = 0; i < kSensorParameterCount; ++i)
    EXPECT_NEAR(builtin.corrections(i), ceres.corrections(i), 1e-5) << i;
  EXPECT_EQ(builtin.outliers, ceres.outliers);
}

TEST(Bundle, TheDepthDelayIsRecoveredBesidesTheStampsOfDepth) {
  BundleWorldSettings settings{.poses = 30, .points = 500, .sigma_px = 0.5, .sigma_inverse_depth = 1.5e-3};
  settings.depth_stamp_difference_s = 0.018;
  settings.sensor(kDepthDelay) = 0.015;
  BundleWorld world = make_bundle_world(settings);
  perturb(world, 0.02, 0.01);
  world.problem.prior.sigma(kDepthDelay) = SensorPrior::kUnknown;
  BundleOptions options;
  options.max_iterations = 20;
  world.problem.sensor.noise.keypoint.coefficient_per_m = 1.5e-3;
  const BundleSolution solution = solve_bundle(world.problem, options);
  EXPECT_NEAR(solution.corrections(kDepthDelay), 0.015, 0.001);
  for (BundleObservation& o : world.problem.observations) o.depth_stamp_difference_s = 0;
  const BundleSolution ignored = solve_bundle(world.problem, options);
  EXPECT_LT(position_error_m(solution.T_world_camera, world.truth),
            position_error_m(ignored.T_world_camera, world.truth));
  EXPECT_LT(solution.chi2_after, ignored.chi2_after);
}

TEST(Bundle, RollingShutterAndDepthDelayAreRecovered) {
  BundleWorldSettings settings{.poses = 30, .points = 500, .sigma_px = 0.5, .sigma_inverse_depth = 1.5e-3};
  settings.sensor(kRollingShutter) = settings.sensor(kDepthShutter) = 0.030;
  settings.sensor(kDepthDelay) = 0.015;
  BundleWorld world = make_bundle_world(settings);
  perturb(world, 0.02, 0.01);
  BundleOptions options;
  options.max_iterations = 20;
  world.problem.sensor.noise.keypoint.coefficient_per_m = 1.5e-3;
  const double ignored = position_error_m(solve_bundle(world.problem, options).T_world_camera, world.truth);

  for (const int i : {kRollingShutter, kDepthDelay, kDepthShutter}) {
    world.problem.prior.sigma(i) = SensorPrior::kUnknown;
  }
  const BundleSolution solution = solve_bundle(world.problem, options);
  EXPECT_NEAR(solution.corrections(kRollingShutter), 0.030, 0.002);
  EXPECT_NEAR(solution.corrections(kDepthDelay), 0.015, 0.002);
  EXPECT_LT(position_error_m(solution.T_world_camera, world.truth), 0.5 * ignored);
  EXPECT_NEAR(solution.corrections(kDepthShutter), 0.030, 0.004);
  for (const int i : {kRollingShutter, kDepthDelay}) {
    const double sigma = std::sqrt(solution.sensor_covariance(i, i));
    EXPECT_LT(std::abs(solution.corrections(i) - settings.sensor(i)), 4 * sigma) << i;
    EXPECT_LT(sigma, 0.001) << i;
  }
}

TEST(Bundle, FocalLengthAndInverseDepthBiasAreRecovered) {
  BundleWorldSettings settings{.poses = 30, .points = 500, .sigma_px = 0.5, .sigma_inverse_depth = 1.5e-3};
  settings.sensor(kFocalX) = 0.01 * test::kinect().fx;
  settings.sensor(kFocalY) = 0.01 * test::kinect().fy;
  settings.sensor(kCenterX) = 2;
  settings.sensor(kInverseDepthBias) = 0.004;
  BundleWorld world = make_bundle_world(settings);
  perturb(world, 0.02, 0.01);
  for (const int i : {kFocalX, kFocalY, kCenterX, kCenterY, kInverseDepthBias}) {
    world.problem.prior.sigma(i) = SensorPrior::kUnknown;
  }
  BundleOptions options;
  options.max_iterations = 30;
  const BundleSolution solution = solve_bundle(world.problem, options);
  EXPECT_NEAR(solution.corrections(kFocalX), settings.sensor(kFocalX), 0.5);
  EXPECT_NEAR(solution.corrections(kFocalY), settings.sensor(kFocalY), 0.5);
  EXPECT_NEAR(solution.corrections(kCenterX), 2, 0.5);
  EXPECT_NEAR(solution.corrections(kInverseDepthBias), 0.004, 0.0005);
  EXPECT_EQ(solution.corrections(kRadial1), 0) << "constant";
  EXPECT_EQ(solution.sensor_covariance(kRadial1, kRadial1), 0);
}

TEST(Bundle, SensorErrorsAreConsistentWithTheirCovariance) {
  BundleWorldSettings settings{.poses = 11, .points = 150, .sigma_px = 0.7, .sigma_inverse_depth = 2e-3};
  settings.sensor(kRollingShutter) = 0.02;
  settings.sensor(kDepthDelay) = -0.01;
  double sensor_sum = 0, pose_sum = 0;
  constexpr int kTrials = 16;
  for (int trial = 0; trial < kTrials; ++trial) {
    settings.seed = static_cast<uint64_t>(trial) + 1;
    BundleWorld world = make_bundle_world(settings);
    perturb(world, 0.01, 0.005, settings.seed);
    world.problem.prior.sigma(kRollingShutter) = SensorPrior::kUnknown;
    world.problem.prior.sigma(kDepthDelay) = SensorPrior::kUnknown;
    BundleOptions options;
    world.problem.sensor.noise.keypoint.coefficient_per_m = 2e-3;
    options.pose_covariances = true;
    const BundleSolution solution = solve_bundle(world.problem, options);
    const Eigen::Matrix2d covariance =
        solution.sensor_covariance.block<2, 2>(kRollingShutter, kRollingShutter);
    const Eigen::Vector2d error = (solution.corrections - settings.sensor).segment<2>(kRollingShutter);
    sensor_sum += error.dot(covariance.inverse() * error);
    const Vector6d pose = test::error_of(solution.T_world_camera[10], world.truth[10]);
    pose_sum += pose.dot(solution.pose_covariance[10].inverse() * pose);
  }
  // Mean chi2 with 2 and 6 degrees of freedom over 16 trials: standard deviations 0.5 and 0.9. The limits are
  // three of these, plus a margin for the information lost by Huber and trimming.
  EXPECT_NEAR(sensor_sum / kTrials, 2, 1.6);
  EXPECT_NEAR(pose_sum / kTrials, 6, 2.7);
}

TEST(Bundle, DepthGradientCorrectsSlantedSurfaces) {
  // A slanted wall. Depth is measured 20 ms late, when another point of the wall lies at the pixel.
  const Eigen::Vector3d normal = Eigen::Vector3d(0.6, 0.1, -1).normalized();
  const double offset = normal.dot(Eigen::Vector3d(0, 0, 2.5));
  constexpr double kDelay_s = 0.02;
  const PinholeCamera camera = test::kinect();
  Random random(4);
  BundleWorld world = make_bundle_world({.poses = 12, .points = 0});
  for (int j = 0; j < 300; ++j) {
    Eigen::Vector3d p(0, 0, 0);
    p.head<2>() = test::uniform_vector<2>(random, {-1.5, -1}, {1.5, 1});
    p.z() = (offset - normal.x() * p.x() - normal.y() * p.y()) / normal.z();
    world.points.push_back(p);
    for (uint32_t i = 0; i < 12; ++i) {
      const Eigen::Vector3d p_camera = world.truth[i].inverse() * p;
      if (p_camera.z() < 0.4 || !camera.contains(camera.project(p_camera))) continue;
      BundleObservation o;
      o.pose = i;
      o.point = static_cast<uint32_t>(j);
      o.pixel = camera.project(p_camera);
      const SE3 T_depth = test::path(i * 0.2 + kDelay_s);
      const Eigen::Vector3d n_camera = T_depth.rotation.conjugate() * normal;
      const double d_camera = offset - normal.dot(T_depth.translation);
      o.depth_m = d_camera / n_camera.dot(camera.unproject(o.pixel, 1));
      o.inverse_depth_gradient = {n_camera.x() / camera.fx / d_camera, n_camera.y() / camera.fy / d_camera};
      world.problem.observations.push_back(o);
    }
  }
  world.problem.p_world = world.points;
  world.problem.sensor.corrections(kDepthDelay) = kDelay_s;
  perturb(world, 0.01, 0.005);
  const auto with = solve_bundle(world.problem, thorough());
  for (auto& o : world.problem.observations) o.inverse_depth_gradient.setZero();
  const auto without = solve_bundle(world.problem, thorough());
  EXPECT_LT(position_error_m(with.T_world_camera, world.truth), 1e-3);
  EXPECT_LT(position_error_m(with.T_world_camera, world.truth),
            0.1 * position_error_m(without.T_world_camera, world.truth));
}

TEST(Bundle, TenPercentOutliers) {
  BundleWorldSettings settings{.sigma_px = 0.5, .sigma_inverse_depth = 2e-3, .outlier_fraction = 0.1};
  BundleWorld world = make_bundle_world(settings);
  perturb(world, 0.01, 0.005);
  BundleOptions options;
  options.rounds = 4;
  world.problem.sensor.noise.keypoint.coefficient_per_m = 2.85e-3;
  const BundleSolution solution = solve_bundle(world.problem, options);
  settings.outlier_fraction = 0;
  EXPECT_LT(position_error_m(solution.T_world_camera, world.truth), 0.005);
  size_t missed = 0, wrong = 0, right_lost = 0;
  for (size_t i = 0; i < world.wrong.size(); ++i) {
    wrong += world.wrong[i];
    missed += world.wrong[i] != 0 && solution.outliers[i] == 0;
    right_lost += world.wrong[i] == 0 && solution.outliers[i] != 0;
  }
  EXPECT_GT(wrong, 80U);
  EXPECT_LT(missed, wrong / 20);
  EXPECT_LT(right_lost, world.wrong.size() / 8);
}

TEST(Bundle, ResultDoesNotDependOnTheNumberOfThreads) {
  BundleWorldSettings settings{.poses = 15, .points = 300, .sigma_px = 1, .sigma_inverse_depth = 2e-3};
  BundleWorld world = make_bundle_world(settings);
  perturb(world, 0.01, 0.005);
  for (const int i : {kFocalX, kRollingShutter, kDepthDelay}) world.problem.prior.sigma(i) = 1;
  BundleOptions options;
  const BundleSolution one = solve_bundle(world.problem, options);
  options.threads = 3;
  const BundleSolution three = solve_bundle(world.problem, options);
  for (size_t i = 0; i < world.truth.size(); ++i) {
    EXPECT_EQ(one.T_world_camera[i].translation, three.T_world_camera[i].translation);
    EXPECT_EQ(one.T_world_camera[i].rotation.coeffs(), three.T_world_camera[i].rotation.coeffs());
  }
  EXPECT_EQ(one.p_world, three.p_world);
  EXPECT_EQ(one.corrections, three.corrections);
}

TEST(Bundle, DegenerateInputsAreIgnored) {
  BundleWorld world = make_bundle_world({.points = 100});
  perturb(world, 0.01, 0.005);
  BundleProblem& problem = world.problem;
  const auto add = [&](uint32_t pose, const Eigen::Vector2d& pixel, double depth_m) {
    problem.observations.push_back({{pixel, depth_m}, pose, static_cast<uint32_t>(problem.p_world.size())});
    problem.p_world.emplace_back(0.1, 0.2, 2.0);
  };
  add(3, {100, 100}, 0);                  // observed once, without depth
  add(3, {kNan, 100}, 2.0);               // not a number
  add(4, {100, 100}, kNan);               // only depth invalid: still too few observations
  problem.p_world.emplace_back(0, 0, 0);  // not observed at all
  problem.observations[0].sigma_px = 0;
  const BundleSolution solution = solve_bundle(problem, thorough());
  EXPECT_LT(position_error_m(solution.T_world_camera, world.truth), 1e-6);
  for (size_t i = 100; i < problem.p_world.size(); ++i) {
    EXPECT_EQ(solution.point_used[i], 0) << i;
    EXPECT_EQ(solution.p_world[i], problem.p_world[i]);
  }
  EXPECT_EQ(solution.outliers[0], 1);
}

TEST(Bundle, EmptyAndInvalidProblems) {
  EXPECT_TRUE(solve_bundle({}, {}).T_world_camera.empty());
  BundleProblem lonely;
  lonely.sensor = test::kinect_sensor();
  lonely.T_world_camera.resize(3);
  EXPECT_EQ(solve_bundle(lonely, {}).T_world_camera.size(), 3U);

  BundleWorld world = make_bundle_world({.points = 20});
  world.problem.observations[0].point = 20;
  EXPECT_THROW(solve_bundle(world.problem, {}), std::logic_error);
  world.problem.observations[0].point = 0;
  world.problem.fixed.pop_back();
  EXPECT_THROW(solve_bundle(world.problem, {}), std::logic_error);
}

}  // namespace
}  // namespace kinloop
