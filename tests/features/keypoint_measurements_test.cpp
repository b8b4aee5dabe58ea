#include "kinloop/features/keypoint_measurements.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

/// Two keypoints whose every number differs; the second has no known slope.
Features two_keypoints() {
  Features features;
  features.pixels = {{10, 20}, {30, 40}};
  features.depths_m = {1.5F, 2.5F};
  features.raw_pixels = {{11, 24}, {31, 96}};
  features.measured_pixels = {{12, 25}, {32, 45}};
  features.measured_depths_m = {1.25F, 0};
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  features.inverse_depth_gradients = {{0.5F, -0.25F}, {kNan, kNan}};
  features.sigmas_px = {1.5F, 2};
  features.depth_stamp_difference_s = -0.0625F;
  return features;
}

TEST(KeypointMeasurement, CompensatedIsOfACameraAtRest) {
  const KeypointMeasurement measured = compensated_measurement(two_keypoints(), 1);
  EXPECT_EQ(measured.pixel, Eigen::Vector2d(30, 40));
  EXPECT_EQ(measured.depth_m, 2.5);
  EXPECT_EQ(measured.sigma_px, 2);
  EXPECT_EQ(measured.row, 0);
  EXPECT_EQ(measured.depth_stamp_difference_s, 0);
  EXPECT_EQ(measured.inverse_depth_gradient, Eigen::Vector2d::Zero());
}

TEST(KeypointMeasurement, RawKeepsRowGradientAndLag) {
  const KeypointMeasurement measured = raw_measurement(two_keypoints(), 0, 96);
  EXPECT_EQ(measured.pixel, Eigen::Vector2d(12, 25));
  EXPECT_EQ(measured.depth_m, 1.25);
  EXPECT_EQ(measured.sigma_px, 1.5);
  EXPECT_EQ(measured.row, -0.25) << "a quarter of the height above the middle";
  EXPECT_EQ(measured.inverse_depth_gradient, Eigen::Vector2d(0.5, -0.25));
  EXPECT_EQ(measured.depth_stamp_difference_s, -0.0625);
}

TEST(KeypointMeasurement, UnknownDepthAndGradientStayUnknown) {
  Features features = two_keypoints();
  EXPECT_EQ(raw_measurement(features, 1, 96).depth_m, 0);
  EXPECT_TRUE(std::isnan(raw_measurement(features, 1, 96).inverse_depth_gradient.x()));
  features.inverse_depth_gradients.clear();
  EXPECT_EQ(raw_measurement(features, 1, 96).inverse_depth_gradient, Eigen::Vector2d::Zero());
}

}  // namespace
}  // namespace kinloop
