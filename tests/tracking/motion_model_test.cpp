#include "kinloop/tracking/motion_model.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace kinloop
