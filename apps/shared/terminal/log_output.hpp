#pragma once

namespace kinloop {

/// Sends log messages to standard error, each on one line; results go to standard output.
void set_up_log();

}  // namespace kinloop
