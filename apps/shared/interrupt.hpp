#pragma once
// Ctrl-C, SIGTERM and SIGHUP (a terminal that is closed) ask the run to finish with the result so far. A
// second Ctrl-C or SIGTERM ends the program at once.

namespace kinloop {

/// Installs the handler. Under nohup SIGHUP stays ignored.
void install_interrupt_handler();

/// Returns the signal received first, or 0.
int received_signal();

/// Returns whether one was received.
bool interrupted();

/// Waits for one.
void wait_for_interrupt();

}  // namespace kinloop
