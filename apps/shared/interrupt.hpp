#pragma once
// Ctrl-C asks the run to finish with the result so far; a second one ends the program at once.

namespace kinloop {

/// Installs the handler for SIGINT and SIGTERM.
void install_interrupt_handler();

/// Returns whether one of them was received.
bool interrupted();

/// Waits for one.
void wait_for_interrupt();

}  // namespace kinloop
