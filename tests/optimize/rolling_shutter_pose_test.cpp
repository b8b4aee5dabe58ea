#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/optimize/pose/moving_pose.hpp"
#include "tests/optimize/moving_view.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using test::error_of;
using test::kinect;
using test::random_motion;

using test::observe_moving;
using test::random_moving_pose;
using test::rolling_sensor;

TEST(RollingShutterPose, FindsPoseAndVelocityWithoutNoise) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const RollingShutterPose truth = random_moving_pose(random);
    const auto observations = observe_moving(truth, rolling_sensor(), 150, 0, random);
    const RollingShutterPose guess{truth.T_world_camera * random_motion(random, 0.02, 0.01), Velocity{}};
    const VelocitySigma unknown{100, 100};
    const auto found =
        solve_rolling_shutter_pose(Sensor{kinect(), {}, rolling_sensor()}, observations, guess, unknown, {});
    ASSERT_TRUE(found.has_value());
    EXPECT_LT(error_of(found->T_world_camera, truth.T_world_camera).norm(), 1e-4);
    EXPECT_LT((found->velocity.vector() - truth.velocity.vector()).norm(), 1e-2);
  }
}

TEST(RollingShutterPose, RefinesAnApproximateVelocity) {
  Random random(2);
  double before = 0, after = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const RollingShutterPose truth = random_moving_pose(random);
    const auto observations = observe_moving(truth, rolling_sensor(), 200, 0.7, random);
    RollingShutterPose guess = truth;
    Vector6d off;
    for (double& x : off) x = 0.1 * random.gaussian();
    guess.velocity = Velocity::from_vector(guess.velocity.vector() + off);
    const auto found =
        solve_rolling_shutter_pose(Sensor{kinect(), {}, rolling_sensor()}, observations, guess, {}, {});
    ASSERT_TRUE(found.has_value());
    before += (guess.velocity.angular_rad_s - truth.velocity.angular_rad_s).norm();
    after += (found->velocity.angular_rad_s - truth.velocity.angular_rad_s).norm();
  }
  EXPECT_LT(after, 0.7 * before);
}

TEST(RollingShutterPose, CovarianceFollowsFromTheResiduals) {
  Random random(7);
  for (const double noise_px : {0.25, 2.0}) {  // 1 px is assumed
    double nees = 0;
    constexpr int kTrials = 60;
    NoiseModel noise;
    noise.inlier_chi2_pixel = 1e12;
    for (int trial = 0; trial < kTrials; ++trial) {
      const RollingShutterPose truth = random_moving_pose(random);
      const auto observations = observe_moving(truth, rolling_sensor(), 300, noise_px, random);
      const VelocitySigma unknown{100, 100};
      const auto found = solve_rolling_shutter_pose(Sensor{kinect(), noise, rolling_sensor()}, observations,
                                                    truth, unknown, {});
      ASSERT_TRUE(found.has_value());
      const Vector6d error = (found->T_world_camera.inverse() * truth.T_world_camera).log();
      nees += error.dot(found->covariance.ldlt().solve(error)) / kTrials;
    }
    // 6 is right; depth has no noise here, so its residuals make the mean too small.
    EXPECT_GT(nees, 3) << noise_px;
    EXPECT_LT(nees, 12) << noise_px;
  }
}

TEST(RollingShutterPose, IgnoresOutliers) {
  Random random(3);
  const RollingShutterPose truth = random_moving_pose(random);
  auto observations = observe_moving(truth, rolling_sensor(), 200, 0, random);
  for (size_t i = 0; i < 60; ++i) observations[i].pixel += Eigen::Vector2d(40 + random.uniform(), -25);
  const auto found =
      solve_rolling_shutter_pose(Sensor{kinect(), {}, rolling_sensor()}, observations, truth, {}, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(error_of(found->T_world_camera, truth.T_world_camera).norm(), 1e-3);
}

TEST(RollingShutterPose, VelocityIsUnobservableWithAnIdealSensor) {
  Random random(4);
  const RollingShutterPose truth{random_motion(random, 1.0, 1.0), Velocity{}};
  const auto observations = observe_moving(truth, SensorVector::Zero(), 100, 0.5, random);
  RollingShutterPose guess = truth;
  guess.velocity = Velocity::from_vector(Vector6d::Constant(0.3));
  const auto found = solve_rolling_shutter_pose(test::kinect_sensor(), observations, guess, {}, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((found->velocity.vector() - guess.velocity.vector()).norm(), 1e-9);
}

TEST(RollingShutterPose, TooFewInliersGiveNoSolution) {
  Random random(5);
  const RollingShutterPose truth = random_moving_pose(random);
  auto observations = observe_moving(truth, rolling_sensor(), 10, 0, random);
  for (size_t i = 0; i < 6; ++i) {
    observations[i].pixel = test::uniform_vector<2>(random, {0, 0}, {640, 480});
  }
  EXPECT_FALSE(solve_rolling_shutter_pose(Sensor{kinect(), {}, rolling_sensor()}, observations, truth, {}, {})
                   .has_value());
  EXPECT_FALSE(
      solve_rolling_shutter_pose(Sensor{kinect(), {}, rolling_sensor()}, {}, truth, {}, {}).has_value());
}

}  // namespace
}  // namespace kinloop
