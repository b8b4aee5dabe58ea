#pragma once

#include <string>

namespace kinloop {

/// Returns "kinloop" and its version.
std::string program_name();

}  // namespace kinloop
