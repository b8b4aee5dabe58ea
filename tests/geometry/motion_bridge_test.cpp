#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/geometry/velocity.hpp"

namespace kinloop {
namespace {

constexpr AccelerationNoise kHandheld{1, 4};

/// The camera of a motion given as a function of time in s.
template <typename Motion>
MovingCamera camera_at(const Motion& motion, double time_s) {
  constexpr double kStep_s = 1e-4;
  const SE3 T = motion(time_s);
  return {std::llround(time_s * kNsPerSecond), T, velocity_between(T, motion(time_s + kStep_s), kStep_s)};
}

SE3 spiral(double time_s) {
  return {exp_so3({0.2 * time_s, 0.9 * time_s, -0.1 * time_s}), {0.3 * time_s, 0.1 * time_s * time_s, 1}};
}

TEST(MotionBridge, FollowsAConstantAccelerationAndTurnRate) {
  const MovingCamera before = camera_at(spiral, 0), after = camera_at(spiral, 1.5);
  for (const double time_s : {0.0, 0.3, 0.75, 1.2, 1.5}) {
    const SE3 T =
        bridge_motion(before, after, std::llround(time_s * kNsPerSecond), kHandheld, {}).T_world_camera;
    EXPECT_LT((spiral(time_s).inverse() * T).log().norm(), 1e-4) << time_s;
  }
}

TEST(MotionBridge, IsCertainAtBothEndsAndLeastInTheMiddle) {
  const MovingCamera before = camera_at(spiral, 0), after = camera_at(spiral, 2);
  const auto variance_m2 = [&](double time_s) {
    return bridge_motion(before, after, std::llround(time_s * kNsPerSecond), kHandheld, {}).covariance(0, 0);
  };
  EXPECT_EQ(variance_m2(0), 0);
  EXPECT_EQ(variance_m2(2), 0);
  EXPECT_NEAR(variance_m2(1), 8.0 / 192, 1e-12);  // q T^3 / 192
  EXPECT_LT(variance_m2(0.5), variance_m2(1));
  EXPECT_NEAR(variance_m2(0.5), variance_m2(1.5), 1e-12);
}

TEST(MotionBridge, CountsTheNoiseOfTheVelocities) {
  const MovingCamera before = camera_at(spiral, 0), after = camera_at(spiral, 2);
  const Velocity noise{Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Zero()};
  const Matrix6d covariance = bridge_motion(before, after, kNsPerSecond, {}, noise).covariance;
  EXPECT_NEAR(covariance(0, 0), 2 * 0.25 * 0.25 * 0.01, 1e-12);  // each velocity counts a quarter of a second
  EXPECT_EQ(covariance(3, 3), 0);
}

/// Random walks of velocity: the covariance is that of their errors.
TEST(MotionBridge, ItsCovarianceIsTrue) {
  constexpr int kWalks = 400, kSteps = 60;
  constexpr double kStep_s = 1.0 / kSteps;
  Random random(3);
  double squared_errors = 0;
  for (int walk = 0; walk < kWalks; ++walk) {
    Eigen::Vector3d position_m(0, 0, 0), velocity_m_s(0.5, 0, 0), middle_m(0, 0, 0);
    const MovingCamera before{0, {Eigen::Quaterniond::Identity(), position_m}, {velocity_m_s, {0, 0, 0}}};
    for (int i = 0; i < kSteps; ++i) {
      if (i == kSteps / 2) middle_m = position_m;
      const Eigen::Vector3d change(random.gaussian(), random.gaussian(), random.gaussian());
      const Eigen::Vector3d next_m_s = velocity_m_s + std::sqrt(kHandheld.linear_m2_s3 * kStep_s) * change;
      position_m += kStep_s * (velocity_m_s + next_m_s) / 2;
      velocity_m_s = next_m_s;
    }
    const MovingCamera after{
        kNsPerSecond, {Eigen::Quaterniond::Identity(), position_m}, {velocity_m_s, {0, 0, 0}}};
    const BridgedPose pose = bridge_motion(before, after, kNsPerSecond / 2, kHandheld, {});
    squared_errors += (pose.T_world_camera.translation - middle_m).squaredNorm() / pose.covariance(0, 0);
  }
  EXPECT_NEAR(squared_errors / (3 * kWalks), 1, 0.15);
}

TEST(MotionBridge, RejectsMomentsThatAreNotInOrder) {
  const MovingCamera camera = camera_at(spiral, 1);
  EXPECT_THROW((void)bridge_motion(camera, camera, camera.stamp_ns, kHandheld, {}), std::logic_error);
}

}  // namespace
}  // namespace kinloop
