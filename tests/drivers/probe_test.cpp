#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/probe/sequence_statistics.hpp"

namespace kinloop {
namespace {

using testing::DoubleNear;

TEST(RateStatistics, GapsDoNotCountAsJitter) {
  constexpr int64_t kMillisecond_ns = 1'000'000;
  std::vector<int64_t> stamps_ns = {0};
  for (int i = 0; i < 40; ++i)
    stamps_ns.push_back(stamps_ns.back() + (i == 20 ? 200 : 32 + i % 3) * kMillisecond_ns);
  const auto rate = rate_statistics(stamps_ns);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->median_interval_s, 0.033, 1e-12);
  EXPECT_NEAR(rate->jitter_s, 0.001, 1e-12);
  EXPECT_EQ(rate->gaps, 1U);
  EXPECT_NEAR(rate->longest_gap_s, 0.2, 1e-12);
  EXPECT_FALSE(rate_statistics(std::vector<int64_t>{0, 1}));
}

TEST(DepthStatistics, CountOnlyKnownDepth) {
  Frame frame;
  frame.depth_m = cv::Mat(64, 64, CV_32FC1, cv::Scalar(2));
  frame.depth_m.colRange(0, 32).setTo(0);
  const DepthStatistics depth = depth_statistics({&frame, 1});
  EXPECT_EQ(depth.depth_m.median, 2);
  EXPECT_EQ(depth.valid_share, 0.5);
}

TEST(PlausibleDepthScale, MillimetresReadAsTumUnitsAndTheOtherWayRound) {
  EXPECT_EQ(plausible_depth_scale(0.2, 5000), 1000);
  EXPECT_EQ(plausible_depth_scale(1800, 1), 1000);
  EXPECT_FALSE(plausible_depth_scale(2, 1000));
  EXPECT_FALSE(plausible_depth_scale(0, 1000));
}

/// Bright squares in front of a dark wall, with depth shifted by (dx, dy) against colour.
Frame shifted_frame(int dx, int dy) {
  Frame frame;
  cv::Mat color(480, 640, CV_8UC3, cv::Scalar::all(40));
  frame.depth_m = cv::Mat(480, 640, CV_32FC1, cv::Scalar(3));
  cv::RNG random(3);
  for (int i = 0; i < 12; ++i) {
    const int y = 60 + 130 * (i / 4) + random.uniform(0, 20);
    const cv::Point at(60 + 130 * (i % 4) + random.uniform(0, 20), y);
    const int height = 50 + random.uniform(0, 20);
    const cv::Size size(50 + random.uniform(0, 20), height);
    cv::rectangle(color, {at, size}, cv::Scalar::all(120 + 10 * i), cv::FILLED);
    cv::rectangle(frame.depth_m, {at + cv::Point(dx, dy), size}, 1.5, cv::FILLED);
  }
  frame.color = color;
  return frame;
}

TEST(Misregistration, FindsTheShiftFromDepthToColour) {
  for (const cv::Point shift : {cv::Point(0, 0), cv::Point(7, -4), cv::Point(-12, 3)}) {
    const Frame frame = shifted_frame(shift.x, shift.y);
    const auto found = misregistration({&frame, 1});
    ASSERT_TRUE(found);
    EXPECT_THAT(found->shift_px.x(), DoubleNear(-shift.x, 0.6));
    EXPECT_THAT(found->shift_px.y(), DoubleNear(-shift.y, 0.6));
  }
}

TEST(Misregistration, IsUnknownWithoutBorders) {
  Frame frame = shifted_frame(0, 0);
  frame.depth_m.setTo(2);
  EXPECT_FALSE(misregistration({&frame, 1}));
}

}  // namespace
}  // namespace kinloop
