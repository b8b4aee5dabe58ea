#pragma once
// How threads share a processor that is too small for all of them.

namespace kinloop {

/// How much of the processor a thread leaves to others that want it.
enum class ThreadPriority {
  kLow,     ///< nine tenths: it still answers soon
  kLowest,  ///< all but a thirtieth
};

/// From now on the calling thread, and those it starts, work only as far as others leave it time.
void lower_thread_priority(ThreadPriority priority);

}  // namespace kinloop
