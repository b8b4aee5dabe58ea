#include "kinloop/slam/executor.hpp"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

std::unique_ptr<Executor> executor(ExecutorMode mode) {
  ExecutorOptions options;
  options.mode = mode;
  options.local_ba_lag_frames = 3;
  options.loop_correction_lag_frames = 5;
  return make_executor(options);
}

MapUpdate numbered(uint32_t number) {
  MapUpdate update;
  update.epoch = number;
  return update;
}

TEST(Executor, LaggedResultsArriveAfterTheLag) {
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(JobKind::kLocalBundleAdjustment, FrameId{10}, [] { return numbered(1); });
  EXPECT_TRUE(lagged->busy(JobKind::kLocalBundleAdjustment));
  EXPECT_FALSE(lagged->busy(JobKind::kLoopCorrection));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // long finished, but not due yet
  EXPECT_TRUE(lagged->collect(FrameId{12}).empty());
  const auto finished = lagged->collect(FrameId{13});
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished[0].result.update.epoch, 1U);
  EXPECT_FALSE(lagged->busy(JobKind::kLocalBundleAdjustment));
}

TEST(Executor, LaggedWaitsForSlowWork) {
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(JobKind::kLocalBundleAdjustment, FrameId{0}, [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return numbered(7);
  });
  ASSERT_EQ(lagged->collect(FrameId{3}).size(), 1U);
}

TEST(Executor, InlineResultsArriveWithTheNextFrame) {
  const auto at_once = executor(ExecutorMode::kInline);
  bool done = false;
  at_once->submit(JobKind::kLoopCorrection, FrameId{4}, [&] {
    done = true;
    return numbered(2);
  });
  EXPECT_TRUE(done);
  EXPECT_EQ(at_once->collect(FrameId{5}).size(), 1U);
}

TEST(Executor, ResultsKeepTheOrderOfSubmission) {
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(JobKind::kLocalBundleAdjustment, FrameId{0}, [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    return numbered(1);
  });
  lagged->submit(JobKind::kLoopCorrection, FrameId{0}, [] { return numbered(2); });
  const auto finished = lagged->drain();
  ASSERT_EQ(finished.size(), 2U);
  EXPECT_EQ(finished[0].result.update.epoch, 1U);
  EXPECT_EQ(finished[1].kind, JobKind::kLoopCorrection);
  EXPECT_TRUE(lagged->drain().empty());
}

TEST(Executor, OneJobOfAKindAtATime) {
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(JobKind::kLocalBundleAdjustment, FrameId{0}, [] { return MapUpdate{}; });
  EXPECT_THROW(lagged->submit(JobKind::kLocalBundleAdjustment, FrameId{1}, [] { return MapUpdate{}; }),
               std::logic_error);
}

TEST(Executor, AnErrorInAJobReachesTheCollector) {
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(JobKind::kLocalBundleAdjustment, FrameId{0},
                 []() -> MapUpdate { throw std::runtime_error("no"); });
  EXPECT_THROW(lagged->collect(FrameId{3}), std::runtime_error);
}

}  // namespace
}  // namespace kinloop
