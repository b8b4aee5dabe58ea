#pragma once

#include <string>
#include <string_view>

namespace kinloop {

/// Returns the bytes in gzip format (RFC 1952).
std::string gzipped(std::string_view bytes);

}  // namespace kinloop
