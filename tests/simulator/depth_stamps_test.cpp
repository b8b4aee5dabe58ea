// Stamps of simulated depth compared with those of TUM's freiburg1 recordings.

#include "simulator/sensors/depth_stamps.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/association.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop::sim {
namespace {

std::vector<int64_t> even_stamps(int count, double interval_s) {
  std::vector<int64_t> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(to_ns(5 + i * interval_s));
  return stamps;
}

std::vector<double> lags_ms(const std::vector<FrameStamps>& frames) {
  std::vector<double> lags;
  for (const FrameStamps& frame : frames) lags.push_back(1e3 * to_seconds(frame.depth_ns - frame.color_ns));
  return lags;
}

double spread(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double value : values) sum += value, squares += value * value;
  const auto count = static_cast<double>(values.size());
  return std::sqrt(squares / count - sum * sum / count / count);
}

TEST(DepthStamps, LagsAreSpreadLikeThoseOfFreiburg1) {
  // Of freiburg1: standard deviation 10-12 ms, from -20 to 17 ms.
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto lags = lags_ms(with_depth_stamps(even_stamps(3000, 1.0 / 30), seed));
    EXPECT_NEAR(spread(lags), 10, 2.5) << seed;
    const auto [least, most] = std::minmax_element(lags.begin(), lags.end());
    EXPECT_GE(*least, -20);
    EXPECT_LE(*most, 20);
    EXPECT_LT(*least, -14);
    EXPECT_GT(*most, 14);
  }
}

TEST(DepthStamps, TheLagDriftsSlowlyWithJitterAndWrapsAround) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto lags = lags_ms(with_depth_stamps(even_stamps(3000, 1.0 / 30), seed));
    std::vector<double> steps;
    size_t wraps = 0;
    for (size_t i = 1; i < lags.size(); ++i) {
      const double step = std::abs(lags[i] - lags[i - 1]);
      if (step > 20) {
        ++wraps;
      } else {
        steps.push_back(lags[i] - lags[i - 1]);
      }
    }
    EXPECT_GT(wraps, 0U) << seed;
    EXPECT_GT(spread(steps), 1.5) << "of two images' jitter";
    EXPECT_LT(spread(steps), 4.5);
  }
}

TEST(DepthStamps, SomeFramesAreLostAndNoneIsUsedTwice) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto frames = with_depth_stamps(even_stamps(3000, 1.0 / 30), seed);
    EXPECT_LT(frames.size(), 3000U);
    EXPECT_GT(frames.size(), 2700U);
    for (size_t i = 1; i < frames.size(); ++i) {
      ASSERT_GT(frames[i].color_ns, frames[i - 1].color_ns);
      ASSERT_GT(frames[i].depth_ns, frames[i - 1].depth_ns);
    }
  }
}

TEST(DepthStamps, FitAnyRateOfFrames) {
  for (const double interval_s : {0.004, 0.01, 0.04, 0.1, 0.5}) {
    const auto frames = with_depth_stamps(even_stamps(500, interval_s), 3);
    EXPECT_GT(frames.size(), 420U) << interval_s;
    for (const FrameStamps& frame : frames)
      EXPECT_LE(std::abs(frame.depth_ns - frame.color_ns), kMaxAssociationNs);
  }
  EXPECT_EQ(with_depth_stamps(even_stamps(1, 1), 3).size(), 1U);
  EXPECT_TRUE(with_depth_stamps({}, 3).empty());
}

TEST(DepthStamps, AreAFunctionOfTheSeed) {
  const auto stamps = even_stamps(50, 1.0 / 30);
  EXPECT_EQ(lags_ms(with_depth_stamps(stamps, 1)), lags_ms(with_depth_stamps(stamps, 1)));
  EXPECT_NE(lags_ms(with_depth_stamps(stamps, 1)), lags_ms(with_depth_stamps(stamps, 2)));
}

}  // namespace
}  // namespace kinloop::sim
