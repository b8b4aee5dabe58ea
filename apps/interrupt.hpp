#pragma once
// Ctrl-C asks the run to finish with what there is; a second one ends the program at once.

namespace kinloop {

/// Installs the handler for SIGINT and SIGTERM.
void catch_interrupts();

/// Whether one of them came.
bool interrupted();

/// Waits for one.
void wait_for_interrupt();

}  // namespace kinloop
