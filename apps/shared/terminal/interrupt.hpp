#pragma once
// Ctrl-C, SIGTERM and SIGHUP (a terminal that is closed) ask the run to finish with the result so far. A
// second Ctrl-C or SIGTERM ends the program at once.

#include <exception>

#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Ends a command whose unfinished result is of no use: destructors remove its temporary files.
class Interrupted : public std::exception {
 public:
  explicit Interrupted(int signal) : signal_(signal) {}
  [[nodiscard]] int signal() const { return signal_; }
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }

 private:
  int signal_;
};

/// Installs the handler. Under nohup SIGHUP stays ignored.
void install_interrupt_handler();

/// Returns the signal received first, or 0.
int received_signal();

/// Returns whether one was received.
bool interrupted();

/// Throws Interrupted if one was received.
void throw_if_interrupted();

/// Returns a progress that is shown by `shown`, which may be empty, and throws Interrupted.
Progress interruptible(Progress shown);

/// Waits for one.
void wait_for_interrupt();

}  // namespace kinloop
