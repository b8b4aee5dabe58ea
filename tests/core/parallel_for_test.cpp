#include "kinloop/core/threads/parallel_for.hpp"

#include <atomic>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "kinloop/core/stopwatch.hpp"

namespace kinloop {
namespace {

TEST(ParallelFor, EveryIndexIsVisitedOnceWhateverTheThreads) {
  for (const size_t count : {0, 1, 2, 3, 7, 100, 1001}) {
    for (const int threads : {-1, 0, 1, 2, 3, 8, 200}) {
      std::vector<int> visits(count, 0);
      parallel_for(count, threads, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) ++visits.at(i);
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " items, " << threads << " threads";
    }
  }
}

TEST(ParallelFor, StopwatchesIncludeTheCpuTimeOfWorkers) {
  constexpr double kEach_s = 0.02;
  const Stopwatch watch;
  parallel_for(3, 3, [](size_t, size_t) {
    const Stopwatch own;
    while (own.cpu_s() < kEach_s) {
    }
  });
  EXPECT_GE(watch.cpu_s(), 3 * kEach_s);
}

TEST(ParallelFor, NothingToDoCallsNothing) {
  parallel_for(0, 4, [](size_t, size_t) { FAIL() << "called"; });
}

TEST(ParallelFor, TheFirstExceptionComesOutAfterAllPiecesHaveEnded) {
  std::atomic<int> ended = 0;
  const auto body = [&](size_t begin, size_t) {
    ++ended;
    if (begin > 0) throw std::runtime_error("piece from " + std::to_string(begin));
  };
  try {
    parallel_for(100, 4, body);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "piece from 25");
  }
  EXPECT_EQ(ended, 4);
}

TEST(ParallelFor, ThereIsAtLeastOneThread) {
  EXPECT_GE(hardware_threads(), 1);
}

}  // namespace
}  // namespace kinloop
