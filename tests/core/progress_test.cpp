#include "kinloop/core/progress.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/stopwatch.hpp"

namespace kinloop {
namespace {

TEST(Progress, WithoutAListenerWorkGoesOn) {
  EXPECT_TRUE(report({}, "mapping", 1, 2));
}

TEST(Progress, ListenerReceivesAllReportsAndDecides) {
  ProgressReport heard;
  const Progress stop = [&](const ProgressReport& now) {
    heard = now;
    return false;
  };
  EXPECT_FALSE(report(stop, "mapping", 3, 4));
  EXPECT_EQ(heard.stage, "mapping");
  EXPECT_EQ(heard.done, 3U);
  EXPECT_EQ(heard.total, 4U);
}

TEST(Stopwatch, NeverRunsBackwards) {
  const Stopwatch watch;
  const double wall_s = watch.wall_s(), cpu_s = watch.cpu_s();
  EXPECT_GE(wall_s, 0);
  EXPECT_GE(cpu_s, 0);
  EXPECT_GE(watch.wall_s(), wall_s);
  EXPECT_GE(watch.cpu_s(), cpu_s);
}

}  // namespace
}  // namespace kinloop
