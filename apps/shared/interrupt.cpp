#include "apps/shared/interrupt.hpp"

#include <chrono>
#include <csignal>
#include <thread>

namespace kinloop {
namespace {

// A signal handler can only access globals; this is the only one of the program.
volatile std::sig_atomic_t g_interrupted = 0;

void on_signal(int signal) {
  g_interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void install_interrupt_handler() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool interrupted() {
  return g_interrupted != 0;
}

void wait_for_interrupt() {
  constexpr std::chrono::milliseconds kBetweenLooks{100};
  while (!interrupted()) std::this_thread::sleep_for(kBetweenLooks);
}

}  // namespace kinloop
