#include "kinloop/tracking/motion/motion_model.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

constexpr double kSpeed_m_s = 0.5;

SE3 motion_of(double x_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, 0, 0}};
}

TEST(MotionModel, KeepsAConstantVelocity) {
  for (const int rate_hz : {5, 30, 60, 90}) {
    MotionModel model;
    const int64_t interval_ns = kNsPerSecond / rate_hz;
    for (int i = 0; i < 10; ++i) {
      model.update(model.velocity_of(motion_of(kSpeed_m_s / rate_hz), interval_ns), interval_ns);
    }
    EXPECT_NEAR(model.velocity().linear_m_s.x(), kSpeed_m_s, 1e-6) << rate_hz;
    EXPECT_NEAR(model.predict(interval_ns).T.translation.x(), kSpeed_m_s / rate_hz, 1e-6) << rate_hz;
  }
}

/// A pose that is compensated for a delay is off by the delay times the error of the velocity before it. The
/// error of the next velocity must not be larger than that of the last, or tracking swings up by itself.
TEST(MotionModel, ErrorsOfTheVelocityDieOutAtAnyRate) {
  constexpr double kDelay_s = 0.012;
  for (const int rate_hz : {15, 30, 60, 90, 200}) {
    MotionModel model;
    const int64_t interval_ns = kNsPerSecond / rate_hz;
    double offset_m = 0.005;  // of the previous pose
    for (int i = 0; i < 2 * rate_hz; ++i) {
      const double velocity_error_m_s = i == 0 ? 0 : model.velocity().linear_m_s.x() - kSpeed_m_s;
      const double next_m = -kDelay_s * velocity_error_m_s;
      const SE3 moved = motion_of(kSpeed_m_s / rate_hz + next_m - offset_m);
      model.update(model.velocity_of(moved, interval_ns), interval_ns);
      offset_m = next_m;
    }
    EXPECT_NEAR(model.velocity().linear_m_s.x(), kSpeed_m_s, 0.005) << rate_hz;
  }
}

TEST(MotionModel, ChangesTheVelocityNoFasterThanAHand) {
  constexpr int kRate_hz = 30;
  constexpr int64_t kInterval_ns = kNsPerSecond / kRate_hz;
  constexpr double kMaxChange_m_s = 0.02 * kRate_hz + 10.0 / kRate_hz;
  constexpr double kMaxChange_rad_s = 0.02 * kRate_hz + 30.0 / kRate_hz;
  const auto speed_m_s = [](const MotionModel& model, double x_m_s) {
    return model.velocity_of(motion_of(x_m_s / kRate_hz), kInterval_ns).linear_m_s.x();
  };
  MotionModel model;
  EXPECT_NEAR(speed_m_s(model, 5), 5, 1e-6) << "nothing to compare it with";
  Velocity before;
  before.linear_m_s.x() = kSpeed_m_s;
  model.update(before, kInterval_ns);
  EXPECT_NEAR(speed_m_s(model, kSpeed_m_s + 0.7), kSpeed_m_s + 0.7, 1e-6);
  EXPECT_NEAR(speed_m_s(model, 5), kSpeed_m_s + kMaxChange_m_s, 1e-6);
  EXPECT_NEAR(speed_m_s(model, -5), kSpeed_m_s - kMaxChange_m_s, 1e-6);
  const SE3 turned = SE3::exp((Vector6d() << 0, 0, 0, 0, 5.0 / kRate_hz, 0).finished());
  EXPECT_NEAR(model.velocity_of(turned, kInterval_ns).angular_rad_s.y(), kMaxChange_rad_s, 1e-6);
}

/// A pose measured with equal variance along and around all axes.
Matrix6d pose_covariance(double sigma) {
  return sigma * sigma * Matrix6d::Identity();
}

TEST(MotionModel, ThePriorContinuesTheMotion) {
  constexpr int64_t kInterval_ns = kNsPerSecond / 30;
  MotionModel model;
  for (int i = 0; i < 10; ++i)
    model.update(model.velocity_of(motion_of(kSpeed_m_s / 30), kInterval_ns), kInterval_ns,
                 pose_covariance(1e-4));
  const SE3 T_reference_previous = motion_of(2);
  const auto prior = model.prior(T_reference_previous, kInterval_ns);
  ASSERT_TRUE(prior.has_value());
  EXPECT_NEAR(prior->mean.T_world_camera.translation.x(), 2 + kSpeed_m_s / 30, 1e-6);
  EXPECT_NEAR(prior->mean.velocity.linear_m_s.x(), kSpeed_m_s, 1e-6);
}

TEST(MotionModel, WhereTheVelocityIsUnknownThePriorSaysLittle) {
  constexpr int64_t kInterval_ns = kNsPerSecond / 30;
  MotionModel model;
  const double unknown = model.prior({}, kInterval_ns)->information(0, 0);
  for (int i = 0; i < 10; ++i) model.update({}, kInterval_ns, pose_covariance(1e-4));
  const double known = model.prior({}, kInterval_ns)->information(0, 0);
  EXPECT_GT(known, 5 * unknown);
  model.update({}, kInterval_ns);  // by a pose of unknown covariance
  EXPECT_DOUBLE_EQ(model.prior({}, kInterval_ns)->information(0, 0), unknown);
  model.update({}, kInterval_ns, pose_covariance(1e-4));
  model.reset();
  EXPECT_DOUBLE_EQ(model.prior({}, kInterval_ns)->information(0, 0), unknown);
}

TEST(MotionModel, ThereIsNoPriorAcrossAGapOrWithinNoTime) {
  MotionModel model;
  EXPECT_TRUE(model.prior({}, kNsPerSecond / 10));
  EXPECT_FALSE(model.prior({}, kNsPerSecond / 5));
  EXPECT_FALSE(model.prior({}, 0));
}

TEST(MotionModel, APoseAheadOfThePriorRaisesTheVelocity) {
  constexpr int64_t kInterval_ns = kNsPerSecond / 30;
  MotionModel model;
  for (int i = 0; i < 10; ++i) model.update({}, kInterval_ns, pose_covariance(1e-4));
  const auto prior = model.prior({}, kInterval_ns);
  const Velocity velocity = prior->velocity_at(motion_of(0.01));
  EXPECT_GT(velocity.linear_m_s.x(), 0.5 * 0.01 * 30);
  EXPECT_LT(velocity.linear_m_s.x(), 2 * 0.01 * 30);
  EXPECT_NEAR(velocity.linear_m_s.y(), 0, 1e-9);
}

/// Where poses are measured as precisely as they are thought to be, and the velocity is a random walk, the
/// estimate must be better than the measurements.
TEST(MotionModel, APriorOfTheTrueMotionReducesTheError) {
  constexpr double kInterval_s = 1.0 / 30, kSigma_m = 0.01, kWalk_m2_s3 = 1;
  constexpr int64_t kInterval_ns = kNsPerSecond / 30;
  Random random(1);
  MotionModel model;
  double x_m = 0, speed_m_s = 0, estimate_m = 0, measured_squares = 0, estimated_squares = 0;
  for (int i = 0; i < 3000; ++i) {
    speed_m_s += std::sqrt(kWalk_m2_s3 * kInterval_s) * random.gaussian();
    x_m += kInterval_s * speed_m_s;
    const double error_m = kSigma_m * random.gaussian();
    const auto prior = model.prior(motion_of(estimate_m), kInterval_ns);
    // The information of the prior is relative to the noise that a pose states of itself.
    const double stated = 1 / prior->information(0, 0), noise = kSigma_m * kSigma_m;
    constexpr double kStatedShare = 0.1;
    const double weight = stated / (stated + kStatedShare * noise);
    const double predicted_m = prior->mean.T_world_camera.translation.x();
    estimate_m = predicted_m + weight * (x_m + error_m - predicted_m);
    model.update(prior->velocity_at(motion_of(estimate_m)), kInterval_ns,
                 pose_covariance(std::sqrt(kStatedShare) * kSigma_m));
    measured_squares += error_m * error_m;
    estimated_squares += (estimate_m - x_m) * (estimate_m - x_m);
  }
  EXPECT_LT(estimated_squares, 0.7 * measured_squares);
}

TEST(MotionModel, APoseThatJumpsDoesNotFollowFromTheMotionBefore) {
  constexpr int64_t kInterval_ns = kNsPerSecond / 30;
  const Matrix6d precise = pose_covariance(1e-4);
  MotionModel model;
  for (int i = 0; i < 10; ++i) model.update({}, kInterval_ns, precise);
  const auto prior = model.prior({}, kInterval_ns);
  EXPECT_TRUE(MotionModel::agrees(*prior, motion_of(0.005), precise));
  EXPECT_FALSE(MotionModel::agrees(*prior, motion_of(0.1), precise));
  EXPECT_TRUE(MotionModel::agrees(*prior, motion_of(0.1), pose_covariance(0.1)))
      << "an uncertain pose may be off";
}

}  // namespace
}  // namespace kinloop
