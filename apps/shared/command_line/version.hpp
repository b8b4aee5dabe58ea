#pragma once

#include <string>

namespace kinloop {

/// Returns "kinloop 0.1.0" and the optional parts of this build.
std::string version_text();

}  // namespace kinloop
