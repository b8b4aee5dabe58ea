#pragma once
// Messages for the person who runs the program: spdlog, on standard error, levels set by the application.

#include <spdlog/spdlog.h>

namespace kinloop {

namespace log = spdlog;

}  // namespace kinloop
