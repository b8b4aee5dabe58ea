#include "drivers/live/device_clock.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

int64_t time_of_day_ns() {
  return std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

TEST(DeviceClock, BeginsWithTheTimeOfDay) {
  DeviceClock clock(125'000);
  const int64_t before = time_of_day_ns(), stamp = clock.stamp_ns(77), after = time_of_day_ns();
  EXPECT_LE(before, stamp);
  EXPECT_LE(stamp, after);
}

TEST(DeviceClock, FollowsTheCounterAcrossWrapAround) {
  DeviceClock clock(125'000);
  const int64_t start = clock.stamp_ns(0xffffff00U);
  EXPECT_EQ(clock.stamp_ns(10) - start, 266 * 125'000);
  EXPECT_EQ(clock.stamp_ns(0xfffffff0U) - start, 240 * 125'000) << "the other stream's image, a little older";
  EXPECT_EQ(clock.stamp_ns(20) - start, 276 * 125'000);
}

TEST(DeviceClock, DoesNotAccumulateRoundingErrors) {
  DeviceClock clock(1e9 / 60e6);
  const int64_t start = clock.stamp_ns(0);
  int64_t stamp = start;
  for (uint32_t i = 1; i <= 60'000; ++i) stamp = clock.stamp_ns(i * 1001);
  EXPECT_EQ(stamp - start, 1'001'000'000);
}

TEST(DeviceClock, RestartsWithTheTimeOfDay) {
  DeviceClock clock(1e12);  // ticks so long that the counter cannot be confused with the time of day
  const int64_t first = clock.stamp_ns(1000);
  clock.restart();
  const int64_t second = clock.stamp_ns(5);
  EXPECT_GE(second, first);
  EXPECT_LE(second, time_of_day_ns());
  EXPECT_EQ(clock.stamp_ns(6) - second, 1'000'000'000'000);
}

}  // namespace
}  // namespace kinloop
