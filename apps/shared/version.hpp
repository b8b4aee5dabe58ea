#pragma once

#include <string>

namespace kinloop {

/// Returns "kinloop" and its version.
std::string program_name();

/// Returns "kinloop 0.1.0" and the optional parts of this build.
std::string version_text();

}  // namespace kinloop
