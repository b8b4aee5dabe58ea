#include "kinloop/back_end/executor.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinloop {
namespace {

using testing::ElementsAre;

std::unique_ptr<Executor> executor(ExecutorMode mode) {
  ExecutorOptions options;
  options.mode = mode;
  return make_executor(options);
}

/// Log of what the jobs did, in order.
using Diary = std::vector<std::string>;

Job job(const char* kind, int lag_frames, Diary& diary, int work_ms = 0) {
  return {kind, lag_frames, [=, &diary]() -> Completion {
            std::this_thread::sleep_for(std::chrono::milliseconds(work_ms));
            return [kind, &diary] { diary.emplace_back(kind); };
          }};
}

void complete(const std::vector<FinishedJob>& jobs) {
  for (const FinishedJob& finished : jobs) finished.complete();
}

TEST(Executor, LaggedResultsArriveAfterTheLag) {
  Diary diary;
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(FrameId{10}, job("paint", 3, diary));
  EXPECT_TRUE(lagged->busy("paint"));
  EXPECT_FALSE(lagged->busy("dry"));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // finished long ago, but not due yet
  EXPECT_TRUE(lagged->collect(FrameId{12}).empty());
  const auto finished = lagged->collect(FrameId{13});
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished[0].kind, "paint");
  EXPECT_FALSE(lagged->busy("paint"));
  EXPECT_TRUE(diary.empty());  // the collector has to complete it
  complete(finished);
  EXPECT_THAT(diary, ElementsAre("paint"));
}

TEST(Executor, EachJobHasItsOwnLag) {
  Diary diary;
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(FrameId{0}, job("slow", 5, diary));
  lagged->submit(FrameId{0}, job("fast", 2, diary));
  complete(lagged->collect(FrameId{2}));
  EXPECT_THAT(diary, ElementsAre("fast"));
  EXPECT_TRUE(lagged->busy("slow"));
  complete(lagged->collect(FrameId{5}));
  EXPECT_THAT(diary, ElementsAre("fast", "slow"));
}

TEST(Executor, LaggedWaitsForSlowWork) {
  Diary diary;
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(FrameId{0}, job("paint", 3, diary, 50));
  EXPECT_EQ(lagged->collect(FrameId{3}).size(), 1U);
}

TEST(Executor, InlineResultsArriveWithTheNextFrame) {
  const auto at_once = executor(ExecutorMode::kInline);
  bool worked = false, completed = false;
  at_once->submit(FrameId{4}, {"paint", 5, [&]() -> Completion {
                                 worked = true;
                                 return [&] { completed = true; };
                               }});
  EXPECT_TRUE(worked);
  EXPECT_FALSE(completed);
  complete(at_once->collect(FrameId{5}));
  EXPECT_TRUE(completed);
}

TEST(Executor, CompletionsRunOnTheCollectingThread) {
  const auto lagged = executor(ExecutorMode::kLagged);
  std::thread::id worker, completer;
  lagged->submit(FrameId{0}, {"paint", 1, [&]() -> Completion {
                                worker = std::this_thread::get_id();
                                return [&] { completer = std::this_thread::get_id(); };
                              }});
  complete(lagged->drain());
  EXPECT_NE(worker, std::this_thread::get_id());
  EXPECT_EQ(completer, std::this_thread::get_id());
}

TEST(Executor, ResultsKeepTheOrderOfSubmission) {
  Diary diary;
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(FrameId{0}, job("first", 9, diary, 30));
  lagged->submit(FrameId{0}, job("second", 2, diary));
  complete(lagged->drain());
  EXPECT_THAT(diary, ElementsAre("first", "second"));
  EXPECT_TRUE(lagged->drain().empty());
}

TEST(Executor, RejectsASecondJobOfTheSameKind) {
  Diary diary;
  const auto lagged = executor(ExecutorMode::kLagged);
  lagged->submit(FrameId{0}, job("paint", 3, diary));
  EXPECT_THROW(lagged->submit(FrameId{1}, job("paint", 3, diary)), std::logic_error);
  lagged->collect(FrameId{3});
  EXPECT_NO_THROW(lagged->submit(FrameId{3}, job("paint", 3, diary)));
}

TEST(Executor, RethrowsExceptionsOfJobs) {
  const auto lagged = executor(ExecutorMode::kLagged);
  Diary diary;
  lagged->submit(FrameId{0}, {"paint", 3, []() -> Completion { throw std::runtime_error("no"); }});
  lagged->submit(FrameId{0}, job("dry", 9, diary));
  EXPECT_THROW(lagged->collect(FrameId{3}), std::runtime_error);
  EXPECT_FALSE(lagged->busy("paint"));
  complete(lagged->drain());
  EXPECT_THAT(diary, ElementsAre("dry"));
}

}  // namespace
}  // namespace kinloop
