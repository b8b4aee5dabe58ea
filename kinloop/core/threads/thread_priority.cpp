#include "kinloop/core/threads/thread_priority.hpp"

#include <algorithm>

#include <sys/resource.h>
#include <unistd.h>

namespace kinloop {

void lower_thread_priority(ThreadPriority priority) {
  // On Linux, PRIO_PROCESS with a thread id applies to that thread alone. If the system refuses, only speed
  // is lost.
  const auto thread = static_cast<id_t>(gettid());
  constexpr int kLowestPriority = 19;
  const int lower = priority == ThreadPriority::kLow ? 10 : 15;
  setpriority(PRIO_PROCESS, thread, std::min(getpriority(PRIO_PROCESS, thread) + lower, kLowestPriority));
}

}  // namespace kinloop
