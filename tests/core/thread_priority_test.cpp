#include "kinloop/core/threads/thread_priority.hpp"

#include <algorithm>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace kinloop {
namespace {

int own_nice() {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
}

/// The nice value of a thread with lowered priority.
int nice_of_worker(ThreadPriority priority) {
  int nice = 0;
  std::thread worker([&] {
    lower_thread_priority(priority);
    nice = own_nice();
  });
  worker.join();
  return nice;
}

TEST(ThreadPriority, LowersOnlyTheCallingThread) {
  const int before = own_nice();  // nonzero under nice(1)
  EXPECT_EQ(nice_of_worker(ThreadPriority::kLow), std::min(before + 10, 19));
  EXPECT_EQ(nice_of_worker(ThreadPriority::kLowest), std::min(before + 15, 19));
  EXPECT_EQ(own_nice(), before);
}

}  // namespace
}  // namespace kinloop
