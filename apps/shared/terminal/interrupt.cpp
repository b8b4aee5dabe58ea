#include "apps/shared/terminal/interrupt.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>
#include <utility>

namespace kinloop {
namespace {

// A signal handler can only access globals; this is the only one of the program. Threads of sources read it.
std::atomic<int> g_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

void on_signal(int signal) {
  int none = 0;
  g_signal.compare_exchange_strong(none, signal);
  // When a terminal is closed, the kernel and the shell may both send SIGHUP: a second one means nothing.
  if (signal != SIGHUP) std::signal(signal, SIG_DFL);
}

}  // namespace

void install_interrupt_handler() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

int received_signal() {
  return g_signal;
}

bool interrupted() {
  return received_signal() != 0;
}

void throw_if_interrupted() {
  if (const int signal = received_signal(); signal != 0) throw Interrupted(signal);
}

Progress interruptible(Progress shown) {
  return [shown = std::move(shown)](const ProgressReport& now) {
    throw_if_interrupted();
    return !shown || shown(now);
  };
}

void wait_for_interrupt() {
  constexpr std::chrono::milliseconds kBetweenLooks{100};
  while (!interrupted()) std::this_thread::sleep_for(kBetweenLooks);
}

}  // namespace kinloop
