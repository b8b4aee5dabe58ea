// The Kinect model compared with its own equations.

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/core/random.hpp"
#include "simulator/sensors/kinect_model.hpp"

namespace kinloop::sim {
namespace {

/// A wall straight ahead, slightly tilted, so that the quantisation error is random.
ExactDepth wall(float depth_m, float tilt = 0.02F, cv::Size size = {200, 200}) {
  ExactDepth exact{cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1, cv::Scalar(1))};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      exact.depth_m.at<float>(y, x) =
          depth_m * (1 + tilt * (static_cast<float>(y) / static_cast<float>(size.height) - 0.5F));
    }
  }
  return exact;
}

struct Errors {
  double mean_m, sigma_m, lost;
};

Errors errors(const ExactDepth& exact, const cv::Mat& measured) {
  double sum = 0, squares = 0;
  int count = 0;
  for (int y = 0; y < measured.rows; ++y) {
    for (int x = 0; x < measured.cols; ++x) {
      const double z = measured.at<float>(y, x);
      if (z <= 0) continue;
      const double error = z - static_cast<double>(exact.depth_m.at<float>(y, x));
      sum += error;
      squares += error * error;
      ++count;
    }
  }
  const double n = std::max(count, 1);
  return {sum / n, std::sqrt(squares / n), 1 - count / static_cast<double>(measured.total())};
}

TEST(KinectModel, DepthNoiseGrowsWithTheSquareOfTheDistance) {
  const KinectNoise noise;
  for (const float depth_m : {0.8F, 1.5F, 2.5F, 4.0F}) {
    const ExactDepth exact = wall(depth_m);
    const Errors e = errors(exact, measured_depth(exact, noise, 17, 1));
    const double model_m = 1.425e-3 * static_cast<double>(depth_m) * static_cast<double>(depth_m);
    EXPECT_NEAR(e.sigma_m / model_m, 1, 0.05) << depth_m;
    EXPECT_LT(std::abs(e.mean_m), 0.15 * model_m) << depth_m;
    EXPECT_LT(e.lost, 0.01) << depth_m;
  }
}

TEST(KinectModel, MeasuredDisparitiesAreWholeSteps) {
  const KinectNoise noise;
  const cv::Mat measured = measured_depth(wall(2), noise, 3, 1);
  size_t known = 0;
  for (auto it = measured.begin<float>(); it != measured.end<float>(); ++it) {
    if (*it <= 0) continue;
    ++known;
    const double steps = kDisparityScale / static_cast<double>(*it) / noise.disparity_step_px;
    ASSERT_NEAR(steps, std::round(steps), 1e-3);
  }
  EXPECT_GT(known, measured.total() / 2);
}

TEST(KinectModel, WithoutNoiseDepthIsExact) {
  const ExactDepth exact = wall(3);
  const cv::Mat measured = measured_depth(exact, KinectNoise::none(), 1, 1);
  EXPECT_EQ(cv::norm(measured, exact.depth_m, cv::NORM_INF), 0);
}

TEST(KinectModel, DepthOutsideTheRangeIsUnknown) {
  EXPECT_EQ(errors(wall(0.3F), measured_depth(wall(0.3F), {}, 1, 1)).lost, 1);
  EXPECT_EQ(errors(wall(6), measured_depth(wall(6), {}, 1, 1)).lost, 1);
  EXPECT_EQ(errors(wall(6), measured_depth(wall(6), KinectNoise::none(), 1, 1)).lost, 1);
}

TEST(KinectModel, TheProjectorsShadowLiesLeftOfNearThings) {
  // Full width, since disparity is in pixels of a 640 px image.
  ExactDepth exact = wall(2, 0, {640, 8});
  exact.depth_m.colRange(300, 400).setTo(1);
  KinectNoise noise;
  noise.depth_noise_per_m = noise.disparity_step_px = 0;
  const cv::Mat measured = measured_depth(exact, noise, 5, 1);
  const int shadow_px = static_cast<int>(kDisparityScale * (1.0 / 1 - 1.0 / 2));
  for (int x = 300 - shadow_px + 1; x < 300; ++x) EXPECT_EQ(measured.at<float>(4, x), 0) << x;
  for (int x = 100; x < 300 - shadow_px - 1; ++x) EXPECT_GT(measured.at<float>(4, x), 0) << x;
  for (int x = 402; x < 600; ++x) EXPECT_GT(measured.at<float>(4, x), 0) << x;
}

TEST(KinectModel, GrazingSurfacesAndGlassGiveHoles) {
  ExactDepth exact = wall(2);
  exact.cosine.setTo(0.05F);
  EXPECT_EQ(errors(exact, measured_depth(exact, {}, 1, 1)).lost, 1);
  exact.cosine.setTo(0.2F);
  const double lost = errors(exact, measured_depth(exact, {}, 1, 1)).lost;
  EXPECT_GT(lost, 0.4);
  EXPECT_LT(lost, 0.8);
  exact.cosine.setTo(0);
  EXPECT_EQ(errors(exact, measured_depth(exact, {}, 1, 1)).lost, 1);
}

TEST(KinectModel, TheWarpIsOffByDefaultAndBoundedOtherwise) {
  const ExactDepth exact = wall(2);
  KinectNoise warped = KinectNoise::none();
  warped.depth_distortion = 0.01;
  const cv::Mat measured = measured_depth(exact, warped, 1, 1);
  const double largest = cv::norm(measured, exact.depth_m, cv::NORM_INF);
  EXPECT_GT(largest, 0.25 * 0.01 * 2);
  EXPECT_LE(largest, 1.05 * 0.01 * 2);
}

TEST(KinectModel, ImageNoiseHasTheRequestedDeviation) {
  KinectNoise noise;
  noise.image_noise = 3;
  for (const float level : {10.0F, 128.0F, 220.0F}) {
    double sum = 0, squares = 0;
    constexpr int kDraws = 20000;
    for (uint64_t i = 0; i < kDraws; ++i) {
      const double error =
          static_cast<double>(noisy_level(level, noise, static_cast<uint32_t>(hash(9, i))) - level);
      sum += error;
      squares += error * error;
    }
    const double sigma = 3 * std::sqrt(0.5 + 0.5 * static_cast<double>(level) / 128);
    EXPECT_NEAR(std::sqrt(squares / kDraws), sigma, 0.03 * sigma);
    EXPECT_NEAR(sum / kDraws, 0, 0.1);
  }
}

TEST(KinectModel, GainStaysWithinTheRequestedRange) {
  KinectNoise noise;
  noise.gain_change = 0.1;
  double low = 2, high = 0;
  for (double t = 0; t < 60; t += 0.1) {
    low = std::min(low, gain_at(noise, t));
    high = std::max(high, gain_at(noise, t));
  }
  EXPECT_GE(low, 0.9);
  EXPECT_LE(high, 1.1);
  EXPECT_GT(high - low, 0.15);
  EXPECT_EQ(gain_at(KinectNoise::none(), 12.3), 1);
}

}  // namespace
}  // namespace kinloop::sim
