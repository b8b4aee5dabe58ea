#pragma once

#include <string>
#include <string_view>

namespace kinloop {

/// Encodes as base64 (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace kinloop
