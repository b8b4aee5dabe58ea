#pragma once
// Scheduling priority of background threads on slow CPUs.

namespace kinloop {

/// How much CPU time a thread yields to others.
enum class ThreadPriority {
  kLow,     ///< yields nine tenths, but still responds soon
  kLowest,  ///< yields all but a thirtieth
};

/// Lowers the priority of the calling thread and of the threads it starts from now on.
void lower_thread_priority(ThreadPriority priority);

}  // namespace kinloop
