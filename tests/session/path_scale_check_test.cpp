#include <cmath>

#include <gmock/gmock.h>

#include "session/input/checks/checks.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kDepthScale = 2500;

/// A loop of a few metres, `scale` times as large, with an error of some millimetres.
Trajectory path(double scale, double error_m = 0.005) {
  Trajectory poses;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.06 * i;
    const Eigen::Vector3d point(std::sin(t), 0.2 * std::sin(3 * t), 1.5 * std::cos(t));
    const Eigen::Vector3d error(std::sin(40 * t), std::cos(50 * t), std::sin(60 * t));
    poses.push_back(
        {33'000'000 * int64_t{i}, {Eigen::Quaterniond::Identity(), scale * point + error_m * error}});
  }
  return poses;
}

TEST(PathScale, NamesTheRatioAndTheDepthScaleThatFits) {
  const auto large = check_path_scale(path(2), path(1), kDepthScale);
  ASSERT_TRUE(large);
  EXPECT_EQ(large->fault, InputFault::kDepthUnit);
  EXPECT_THAT(large->evidence, AllOf(HasSubstr("2 times as large"), HasSubstr("2 times too large")));
  EXPECT_THAT(large->remedy, HasSubstr("--depth-scale 5000 instead of 2500"));
  const auto small = check_path_scale(path(0.2), path(1), kDepthScale);
  ASSERT_TRUE(small);
  EXPECT_THAT(small->evidence, HasSubstr("5 times too small"));
  EXPECT_THAT(small->remedy, HasSubstr("--depth-scale about 500 instead"));
}

TEST(PathScale, NamesNoDepthScaleOfDepthInMetres) {
  const auto warning = check_path_scale(path(2), path(1), std::nullopt);
  ASSERT_TRUE(warning);
  EXPECT_THAT(warning->remedy, HasSubstr("divide it by 2,"));
  EXPECT_THAT(warning->remedy, Not(HasSubstr("depth-scale")));
}

TEST(PathScale, SaysNothingOfAScaleThatSensorsHave) {
  for (const double scale : {0.95, 0.99, 1.0, 1.05})
    EXPECT_FALSE(check_path_scale(path(scale), path(1), kDepthScale)) << scale;
}

TEST(PathScale, SaysNothingIfThePathsDiffer) {
  EXPECT_FALSE(check_path_scale(path(2, 0.7), path(1), kDepthScale));
  Trajectory other = path(1);
  for (StampedPose& pose : other) pose.T_world_camera.translation.x() *= -3;
  EXPECT_FALSE(check_path_scale(path(1), other, kDepthScale));
}

TEST(PathScale, SaysNothingOfTooLittle) {
  EXPECT_FALSE(check_path_scale(path(2), {}, kDepthScale));
  EXPECT_FALSE(check_path_scale({}, path(1), kDepthScale));
  EXPECT_FALSE(check_path_scale(path(0.02), path(0.01), kDepthScale));  // the camera stands
  EXPECT_FALSE(check_path_scale(path(0.2), path(0.17), kDepthScale));   // as wrong as published poses are
  Trajectory few = path(1);
  few.resize(10);
  EXPECT_FALSE(check_path_scale(path(2), few, kDepthScale));
}

}  // namespace
}  // namespace kinloop
