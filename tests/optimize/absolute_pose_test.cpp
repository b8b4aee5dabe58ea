#include "kinloop/optimize/pose/absolute_pose.hpp"

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/optimize/synthetic_view.hpp"

namespace kinloop {
namespace {

using test::error_of;
using test::kinect;
using test::kinect_sensor;
using test::kNan;
using test::make_view;
using test::random_motion;

TEST(AbsolutePose, RecoversTheTruthWithoutNoise) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 truth = random_motion(random, 2.0, 1.5);
    const auto view = make_view(truth, 100, {}, random);
    const SE3 guess = truth * random_motion(random, 0.05, 0.03);
    const auto solution = solve_absolute_pose(kinect_sensor(), view, guess, {});
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-8);
    EXPECT_EQ(solution->inlier_count, 100);
  }
}

TEST(AbsolutePose, PixelsAloneAreEnough) {
  Random random(2);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  const auto view = make_view(truth, 60, {.depth_fraction = 0}, random);
  const auto solution =
      solve_absolute_pose(kinect_sensor(), view, truth * random_motion(random, 0.05, 0.03), {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-8);
}

TEST(AbsolutePose, NormalisedErrorIsConsistent) {
  Random random(3);
  AbsolutePoseOptions options;
  double sum = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SE3 truth = random_motion(random, 1.0, 1.0);
    const auto view =
        make_view(truth, 100,
                  {.sigma_px = 1.3, .sigma_inverse_depth = NoiseModel().keypoint.coefficient_per_m}, random);
    const auto solution =
        solve_absolute_pose(kinect_sensor(), view, truth * random_motion(random, 0.02, 0.01), options);
    ASSERT_TRUE(solution.has_value());
    const Vector6d error = error_of(solution->T_reference_camera, truth);
    sum += error.dot(solution->information * error);
  }
  // The expected mean is 6; 200 trials give a standard deviation of 0.25. Trimming 5 % of good observations
  // and Huber weights cost a few per cent of information.
  EXPECT_NEAR(sum / kTrials, 6.0, 1.2);
}

TEST(AbsolutePose, DetectsOutliers) {
  Random random(4);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  auto view = make_view(truth, 200, {.sigma_px = 0.5, .sigma_inverse_depth = 2e-3}, random);
  for (size_t i = 0; i < view.size(); i += 5) view[i].pixel += Eigen::Vector2d(25, -15);
  const auto solution =
      solve_absolute_pose(kinect_sensor(), view, truth * random_motion(random, 0.03, 0.02), {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 3e-3);
  for (size_t i = 0; i < view.size(); i += 5) EXPECT_EQ(solution->inliers[i], 0) << i;
  EXPECT_GT(solution->inlier_count, 140);
}

TEST(AbsolutePose, WrongDepthKeepsThePixelInlier) {
  Random random(5);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  auto view = make_view(truth, 100, {.depth_fraction = 1}, random);
  for (size_t i = 0; i < view.size(); i += 4) view[i].depth_m *= 1.5;  // the wall behind the edge
  const auto solution =
      solve_absolute_pose(kinect_sensor(), view, truth * random_motion(random, 0.02, 0.02), {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-7);
  EXPECT_EQ(solution->inlier_count, 100);
}

TEST(AbsolutePose, UnobservableDirectionsGiveNoPose) {
  Random random(6);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  auto view = make_view(truth, 8, {.depth_fraction = 0}, random);
  view.resize(2);  // four equations for six unknowns
  AbsolutePoseOptions options;
  options.min_inliers = 2;
  EXPECT_FALSE(solve_absolute_pose(kinect_sensor(), view, truth, options).has_value());
}

TEST(AbsolutePose, AWallAndThreePointsDecideTogether) {
  Random random(8);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  const auto view = make_view(truth, 3, {.depth_fraction = 0}, random);
  // A wall in front of the camera tells its distance and two angles.
  PosePrior wall{truth};
  wall.information.diagonal() << 0, 0, 1e6, 1e6, 1e6, 0;
  AbsolutePoseOptions few;
  few.min_inliers = 3;
  const SE3 guess = truth * SE3::exp((Vector6d() << 0.02, -0.01, 0, 0, 0, 0.01).finished());
  const auto solution = solve_absolute_pose(kinect_sensor(), view, guess, few, wall);
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-6);
  EXPECT_GE(solution->information(2, 2), 1e6);
}

TEST(AbsolutePose, APriorCountsByItsInformation) {
  Random random(9);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  const auto view = make_view(truth, 60, {}, random);
  const SE3 elsewhere = truth * SE3::exp((Vector6d() << 0.003, 0, 0, 0, 0, 0).finished());
  const auto error_m = [&](double information) {
    const PosePrior prior{elsewhere, information * Matrix6d::Identity()};
    const auto solution = solve_absolute_pose(kinect_sensor(), view, truth, {}, prior);
    return solution ? error_of(solution->T_reference_camera, truth).norm() : kNan;
  };
  EXPECT_LT(error_m(1e-3), 1e-6);
  EXPECT_NEAR(error_m(1e12), 0.003, 1e-5);
}

TEST(AbsolutePose, Chi2IsThatOfTheObservationsAlone) {
  Random random(12);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  const auto view = make_view(truth, 60, {}, random);
  Sensor sensor = kinect_sensor();
  sensor.noise.robust_width = 1e9;  // without a loss the cost is quadratic
  // Half as certain as the observations, so that the estimate contradicts both.
  const auto alone = solve_absolute_pose(sensor, view, truth, {});
  ASSERT_TRUE(alone.has_value());
  const SE3 elsewhere = truth * SE3::exp((Vector6d() << 0.001, 0, 0, 0, 0, 0).finished());
  const PosePrior prior{elsewhere, 0.5 * alone->information};
  const auto solution = solve_absolute_pose(sensor, view, truth, {}, prior);
  ASSERT_TRUE(solution.has_value());
  const Vector6d error = error_of(solution->T_reference_camera, truth);
  EXPECT_GT(error.norm(), 1e-4);
  EXPECT_NEAR(solution->chi2 / error.dot(alone->information * error), 1.0, 0.01);
}

TEST(AbsolutePose, NonFiniteObservationsAreIgnored) {
  Random random(7);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  auto view = make_view(truth, 50, {}, random);
  view[3].p_reference.y() = kNan;
  view[11].pixel.x() = kNan;
  view[12].depth_m = kNan;  // treated as unknown
  view[20].sigma_px = kNan;
  view[21].sigma_px = 0;
  view[30].pixel.y() = std::numeric_limits<double>::infinity();
  const auto solution =
      solve_absolute_pose(kinect_sensor(), view, truth * random_motion(random, 0.02, 0.02), {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-8);
  EXPECT_EQ(solution->inlier_count, 45);
  EXPECT_EQ(solution->inliers[3] + solution->inliers[11] + solution->inliers[30], 0);
  EXPECT_EQ(solution->inliers[12], 1);
}

TEST(AbsolutePose, DegenerateInputsHaveNoSolution) {
  Random random(8);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  EXPECT_FALSE(solve_absolute_pose(kinect_sensor(), {}, truth, {}).has_value());

  auto same = make_view(truth, 30, {.depth_fraction = 1}, random);
  for (auto& o : same) o = same.front();
  EXPECT_FALSE(solve_absolute_pose(kinect_sensor(), same, truth, {}).has_value());

  auto line = make_view(truth, 30, {.depth_fraction = 0}, random);
  for (size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector3d p_camera(0.02 * static_cast<double>(i) - 0.3, 0.1, 2.0);
    line[i].p_reference = truth * p_camera;
    line[i].pixel = kinect().project(p_camera);
  }
  EXPECT_FALSE(solve_absolute_pose(kinect_sensor(), line, truth, {}).has_value());

  const auto view = make_view(truth, 30, {}, random);
  const SE3 broken{Eigen::Quaterniond(kNan, 0, 0, 0), Eigen::Vector3d::Zero()};
  EXPECT_FALSE(solve_absolute_pose(kinect_sensor(), view, broken, {}).has_value());
}

TEST(AbsolutePose, PointsBehindTheCameraAreOutliers) {
  Random random(9);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  auto view = make_view(truth, 50, {}, random);
  view[7].p_reference = truth * Eigen::Vector3d(0.1, 0.1, -2.0);
  view[8].p_reference = truth.translation;
  const auto solution =
      solve_absolute_pose(kinect_sensor(), view, truth * random_motion(random, 0.02, 0.02), {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-8);
  EXPECT_EQ(solution->inliers[7], 0);
  EXPECT_EQ(solution->inliers[8], 0);
}

TEST(AbsolutePose, InformationIsTheCurvatureOfTheCost) {
  Random random(10);
  const SE3 truth = random_motion(random, 1.0, 1.0);
  const auto view = make_view(truth, 40, {}, random);
  Sensor sensor = kinect_sensor();
  sensor.noise.robust_width = 1e9;  // without a loss the estimate uses all information
  const auto solution = solve_absolute_pose(sensor, view, truth, {});
  ASSERT_TRUE(solution.has_value());
  // chi2 at truth * exp(x) is x' Omega x to second order. The solver reports chi2 only at its best pose, so
  // the cost is repeated here.
  const auto chi2 = [&](const SE3& T) {
    double sum = 0;
    for (const auto& o : view) {
      const Eigen::Vector3d p = T.inverse() * o.p_reference;
      sum += (kinect().project(p) - o.pixel).squaredNorm() / (o.sigma_px * o.sigma_px);
      const double sigma = NoiseModel().keypoint.coefficient_per_m;
      if (o.depth_m > 0) sum += std::pow((1 / p.z() - 1 / o.depth_m) / sigma, 2);
    }
    return sum;
  };
  for (int trial = 0; trial < 20; ++trial) {
    Vector6d x;
    for (int i = 0; i < 6; ++i) x(i) = 1e-5 * random.gaussian();
    const double predicted = x.dot(solution->information * x);
    EXPECT_NEAR(chi2(truth * SE3::exp(x)) / predicted, 1.0, 1e-3);
  }
}

}  // namespace
}  // namespace kinloop
