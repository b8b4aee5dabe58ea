// Simulated stereo compared with its own equations.

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "simulator/sensors/depth_models.hpp"

namespace kinloop::sim {
namespace {

constexpr double kScale_px_m = 424 * 0.05;

/// A textured wall straight ahead, slightly tilted, so that the quantisation error is random.
ExactDepth textured_wall(float depth_m, float tilt = 0.04F, cv::Size size = {320, 240}) {
  ExactDepth exact{cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1, cv::Scalar(1)), cv::Mat(size, CV_32FC1)};
  for (int y = 0; y < size.height; ++y) {
    exact.depth_m.row(y).setTo(depth_m *
                               (1 + tilt * (static_cast<float>(y) / static_cast<float>(size.height) - 0.5F)));
    for (int x = 0; x < size.width; ++x) exact.reflectance.at<float>(y, x) = (x + y) % 2 == 0 ? 0.4F : 0.6F;
  }
  return exact;
}

/// A wall at 2 m with a pole at 1 m in front of it, from column 150 to 199.
ExactDepth wall_and_pole() {
  ExactDepth exact = textured_wall(2, 0);
  exact.depth_m.colRange(150, 200).setTo(1);
  return exact;
}

StereoNoise without_noise() {
  StereoNoise noise;
  noise.disparity_noise_px = noise.disparity_step_px = 0;
  return noise;
}

/// Depth errors away from the left border, divided by the squared depth.
cv::Mat inverse_errors(const ExactDepth& exact, const cv::Mat& measured, const cv::Range& columns) {
  cv::Mat inverse_exact, inverse_measured;
  cv::divide(1.0, exact.depth_m.colRange(columns), inverse_exact);
  cv::divide(1.0, measured.colRange(columns), inverse_measured);
  return inverse_measured - inverse_exact;
}

TEST(StereoModel, DepthNoiseGrowsWithTheSquareOfTheDistance) {
  const StereoNoise noise;
  for (const float depth_m : {0.7F, 1.5F, 3.0F}) {
    const ExactDepth exact = textured_wall(depth_m);
    const cv::Mat errors =
        inverse_errors(exact, matched_depth(exact, kScale_px_m, noise, 5, 1), {40, exact.depth_m.cols});
    cv::Scalar mean, sigma;
    cv::meanStdDev(errors, mean, sigma);
    // Constant in disparity, so constant in inverse depth.
    EXPECT_NEAR(sigma[0] * kScale_px_m / noise.disparity_noise_px, 1, 0.1) << depth_m;
    EXPECT_LT(std::abs(mean[0]), 0.2 * sigma[0]) << depth_m;
  }
}

TEST(StereoModel, NoiseIsAlikeWithinTheMatchingWindow) {
  const ExactDepth exact = textured_wall(1.5F);
  const cv::Mat errors =
      inverse_errors(exact, matched_depth(exact, kScale_px_m, {}, 5, 1), {40, exact.depth_m.cols});
  const auto correlation = [&](int shift) {
    const cv::Mat a = errors.colRange(0, errors.cols - shift), b = errors.colRange(shift, errors.cols);
    return a.dot(b) / std::sqrt(a.dot(a) * b.dot(b));
  };
  EXPECT_GT(correlation(1), 0.7);
  EXPECT_LT(std::abs(correlation(StereoNoise().window_px + 1)), 0.1);
}

TEST(StereoModel, MeasuredDisparitiesAreWholeSteps) {
  const StereoNoise noise;
  const cv::Mat measured = matched_depth(textured_wall(2), kScale_px_m, noise, 3, 1);
  int known = 0;
  for (auto it = measured.begin<float>(); it != measured.end<float>(); ++it) {
    if (*it <= 0) continue;
    ++known;
    const double steps = kScale_px_m / static_cast<double>(*it) / noise.disparity_step_px;
    ASSERT_NEAR(steps, std::round(steps), 1e-3);
  }
  EXPECT_GT(known, 1000);
}

TEST(StereoModel, NearObjectsAreHalfAWindowTooWide) {
  const cv::Mat measured = matched_depth(wall_and_pole(), kScale_px_m, without_noise(), 1, 1);
  for (const int x : {147, 148, 149, 150, 175, 199, 200, 201, 202}) {
    EXPECT_NEAR(static_cast<double>(measured.at<float>(120, x)), 1, 1e-5) << x;
  }
  for (const int x : {203, 204, 250}) {
    EXPECT_NEAR(static_cast<double>(measured.at<float>(120, x)), 2, 1e-5) << x;
  }
}

TEST(StereoModel, FatteningCanBeSwitchedOff) {
  StereoNoise noise = without_noise();
  noise.fattening = false;
  const cv::Mat measured = matched_depth(wall_and_pole(), kScale_px_m, noise, 1, 1);
  EXPECT_NEAR(static_cast<double>(measured.at<float>(120, 199)), 1, 1e-5);
  EXPECT_NEAR(static_cast<double>(measured.at<float>(120, 200)), 2, 1e-5);
}

TEST(StereoModel, WhatTheSecondCameraDoesNotSeeHasNoDepth) {
  StereoNoise noise = without_noise();
  noise.fattening = false;
  const cv::Mat measured = matched_depth(wall_and_pole(), kScale_px_m, noise, 1, 1);
  const int hidden_px = static_cast<int>(kScale_px_m * (1 / 1.0 - 1 / 2.0));
  for (int x = 150 - hidden_px; x < 150; ++x) EXPECT_EQ(measured.at<float>(120, x), 0) << x;
  EXPECT_GT(measured.at<float>(120, 150 - hidden_px - 2), 0);
  EXPECT_GT(measured.at<float>(120, 200), 0);
}

TEST(StereoModel, ABandAtTheLeftAsWideAsTheDisparityIsInvalid) {
  const cv::Mat measured = matched_depth(textured_wall(1, 0), kScale_px_m, without_noise(), 1, 1);
  const int disparity_px = static_cast<int>(kScale_px_m);
  EXPECT_EQ(cv::countNonZero(measured.colRange(0, disparity_px)), 0);
  EXPECT_GT(measured.at<float>(100, disparity_px + 1), 0);
}

TEST(StereoModel, FarWallsWithoutTextureHaveNoDepth) {
  const auto known = [](float depth_m, bool textured) {
    ExactDepth exact = textured_wall(depth_m, 0);
    if (!textured) exact.reflectance.setTo(0.5);
    const cv::Mat measured = matched_depth(exact, kScale_px_m, without_noise(), 1, 1);
    return measured.at<float>(120, 200) > 0;
  };
  EXPECT_TRUE(known(1, false));  // the projector's pattern suffices
  EXPECT_FALSE(known(4, false));
  EXPECT_TRUE(known(4, true));
}

TEST(StereoModel, DoesNotDependOnTheNumberOfThreads) {
  const cv::Mat one = matched_depth(wall_and_pole(), kScale_px_m, {}, 9, 1);
  const cv::Mat three = matched_depth(wall_and_pole(), kScale_px_m, {}, 9, 3);
  EXPECT_EQ(cv::norm(one, three, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace kinloop::sim
