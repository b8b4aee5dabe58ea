#pragma once
// LZF compression, as used by PCD files (Lehmann, liblzf).

#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

/// Decompresses to `size` bytes; nullopt if the data is invalid.
std::optional<std::string> decompress_lzf(std::string_view compressed, size_t size);

}  // namespace kinloop
