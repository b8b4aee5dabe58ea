#pragma once

#include <string>

namespace kinloop {

/// "kinloop" and its version.
std::string program_name();

/// "kinloop 0.1.0" and which optional parts are in.
std::string version_text();

}  // namespace kinloop
