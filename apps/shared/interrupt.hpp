#pragma once
// Ctrl-C asks the run to finish with what there is; a second one ends the program at once.

namespace kinloop {

/// Installs the handler for SIGINT and SIGTERM.
void install_interrupt_handler();

/// Whether one of them came.
bool interrupted();

/// Waits for one.
void wait_for_interrupt();

}  // namespace kinloop
