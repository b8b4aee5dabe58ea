#pragma once
// User-facing log messages: spdlog on standard error; the application sets the level.

#include <spdlog/spdlog.h>

namespace kinloop {

namespace log = spdlog;

}  // namespace kinloop
