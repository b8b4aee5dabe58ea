#include "kinloop/belief/hand_motion.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "kinloop/belief/relative_covariance.hpp"

namespace kinloop {
namespace {

/// The mean square of how far constant velocity is off after `interval_s`, if it was measured as the mean
/// over `baseline_s`: along one axis, of many random walks of the velocity.
double mean_square_off_m2(double interval_s, double baseline_s, double noise_m2_s3) {
  constexpr int kWalks = 20'000, kSteps = 100;
  std::mt19937 generator(1);
  double sum = 0;
  for (int walk = 0; walk < kWalks; ++walk) {
    double velocity = 0;
    const auto distance_over = [&](double duration_s) {
      const double step_s = duration_s / kSteps;
      std::normal_distribution<double> change(0, std::sqrt(noise_m2_s3 * step_s));
      double distance = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double before = velocity;
        velocity += change(generator);
        distance += 0.5 * (before + velocity) * step_s;
      }
      return distance;
    };
    const double mean_velocity = distance_over(baseline_s) / baseline_s;
    const double off_m = distance_over(interval_s) - interval_s * mean_velocity;
    sum += off_m * off_m;
  }
  return sum / kWalks;
}

TEST(HandMotion, IsARandomWalkOfTheVelocity) {
  const Vector6d noise = hand_acceleration_noise();
  for (const auto& [interval_s, baseline_s] : {std::pair(0.1, 0.1), std::pair(0.2, 0.05)}) {
    const Matrix6d covariance = hand_motion_covariance(interval_s, baseline_s);
    for (const int axis : {0, 3}) {
      const double expected = mean_square_off_m2(interval_s, baseline_s, noise(axis));
      EXPECT_NEAR(covariance(axis, axis), expected, 0.05 * expected);
    }
  }
}

TEST(HandMotion, ExplainsAHandButNoJump) {
  constexpr double kFrame_s = 1.0 / 30;
  const PredictedView predicted{SE3{}, hand_motion_covariance(kFrame_s, kFrame_s)};
  const auto is_explained_by_hand = [&](const Vector6d& x) { return is_explained(predicted, SE3::exp(x)); };
  Vector6d x = Vector6d::Zero();
  x(0) = 9.81 * kFrame_s * kFrame_s;  // it reverses with one g
  EXPECT_TRUE(is_explained_by_hand(x));
  x(0) = 0.15;
  EXPECT_FALSE(is_explained_by_hand(x));
  x(0) = 0;
  x(4) = 0.3;
  EXPECT_FALSE(is_explained_by_hand(x)) << "a turn";
}

}  // namespace
}  // namespace kinloop
