#include "kinloop/optimize/pose/moving_pose.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/optimize/moving_view.hpp"

namespace kinloop {
namespace {

using test::error_of;
using test::kinect;
using test::observe_moving;
using test::random_motion;
using test::random_moving_pose;
using test::rolling_sensor;

const Sensor kSensor{kinect(), {}, rolling_sensor()};

/// A prior that knows the velocity and expects the pose within these, 1 sigma.
MotionPrior prior_at(const RollingShutterPose& mean, double sigma_m, double sigma_rad) {
  MotionPrior prior{mean, Matrix6d::Zero(), Matrix6d::Zero()};
  prior.information.diagonal() << Eigen::Vector3d::Constant(1 / (sigma_m * sigma_m)),
      Eigen::Vector3d::Constant(1 / (sigma_rad * sigma_rad));
  return prior;
}

/// A far plane that fills a small part of the image: to move along it looks like turning.
std::vector<PoseObservation> observe_ambiguous(const RollingShutterPose& truth, Random& random) {
  constexpr int kCount = 40;
  constexpr double kDistance_m = 4, kSigma_px = 1;
  std::vector<PoseObservation> observations;
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d p_camera(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), kDistance_m);
    PoseObservation o;
    o.p_reference = truth.T_world_camera * p_camera;
    o.pixel = kinect().project(p_camera) + kSigma_px * test::gaussian_vector<2>(random);
    o.sigma_px = kSigma_px;
    observations.push_back(o);
  }
  return observations;
}

TEST(MovingPose, AnUncertainPriorLeavesThePoseToTheMeasurements) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const RollingShutterPose truth = random_moving_pose(random);
    const auto observations = observe_moving(truth, rolling_sensor(), 150, 0, random);
    RollingShutterPose mean = truth;
    mean.T_world_camera = truth.T_world_camera * random_motion(random, 0.02, 0.01);
    const auto found =
        solve_moving_pose(kSensor, observations, mean.T_world_camera, prior_at(mean, 100, 100), {});
    ASSERT_TRUE(found.has_value());
    EXPECT_LT(error_of(found->T_world_camera, truth.T_world_camera).norm(), 1e-4);
  }
}

TEST(MovingPose, ThePriorDecidesWhatTheMeasurementsLeaveOpen) {
  Random random(2);
  double by_landmarks = 0, with_prior = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const RollingShutterPose truth{random_motion(random, 1.0, 1.0), {}};
    const auto observations = observe_ambiguous(truth, random);
    const RollingShutterPose mean{truth.T_world_camera * random_motion(random, 0.002, 0.002), {}};
    const Sensor sensor{kinect()};
    const auto alone =
        solve_moving_pose(sensor, observations, mean.T_world_camera, prior_at(mean, 10, 10), {});
    const auto both =
        solve_moving_pose(sensor, observations, mean.T_world_camera, prior_at(mean, 0.002, 0.002), {});
    ASSERT_TRUE(alone && both);
    by_landmarks += error_of(alone->T_world_camera, truth.T_world_camera).norm();
    with_prior += error_of(both->T_world_camera, truth.T_world_camera).norm();
  }
  EXPECT_GT(by_landmarks, 5 * with_prior);
}

TEST(MovingPose, TheVelocityFollowsThePose) {
  Random random(3);
  constexpr double kGain_per_s = 10;
  for (int trial = 0; trial < 10; ++trial) {
    const RollingShutterPose truth = random_moving_pose(random);
    const Vector6d off = random_motion(random, 0.01, 0.01).log();
    // The velocity before was lower by as much as the gain makes of the distance to the pose.
    MotionPrior prior = prior_at({truth.T_world_camera * SE3::exp(-off),
                                  Velocity::from_vector(truth.velocity.vector() - kGain_per_s * off)},
                                 100, 100);
    prior.velocity_gain = kGain_per_s * Matrix6d::Identity();
    const auto observations = observe_moving(truth, rolling_sensor(), 150, 0, random);
    const auto found =
        solve_moving_pose(kSensor, observations, prior.mean.T_world_camera, prior, {.max_iterations = 20});
    ASSERT_TRUE(found.has_value());
    EXPECT_LT(error_of(found->T_world_camera, truth.T_world_camera).norm(), 1e-4);
    EXPECT_LT((found->velocity.vector() - truth.velocity.vector()).norm(), 1e-3);
  }
}

TEST(MovingPose, MeasurementsThatAreNotFiniteAreIgnored) {
  Random random(4);
  const RollingShutterPose truth = random_moving_pose(random);
  auto observations = observe_moving(truth, rolling_sensor(), 150, 0, random);
  observations[3].pixel.x() = test::kNan;
  observations[5].p_reference.y() = test::kNan;
  const auto found =
      solve_moving_pose(kSensor, observations, truth.T_world_camera, prior_at(truth, 1, 1), {});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(error_of(found->T_world_camera, truth.T_world_camera).norm(), 1e-4);
}

TEST(MovingPose, TooFewMeasurementsGiveNoPose) {
  Random random(5);
  const RollingShutterPose truth = random_moving_pose(random);
  const auto observations = observe_moving(truth, rolling_sensor(), 5, 0, random);
  EXPECT_FALSE(solve_moving_pose(kSensor, observations, truth.T_world_camera, prior_at(truth, 1, 1), {}));
  EXPECT_FALSE(solve_moving_pose(kSensor, {}, truth.T_world_camera, prior_at(truth, 1, 1), {}));
}

}  // namespace
}  // namespace kinloop
