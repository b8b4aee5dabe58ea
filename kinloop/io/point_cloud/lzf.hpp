#pragma once
// The compression of PCD files: LZF (Lehmann, liblzf).

#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

/// What was compressed, `size` bytes; nothing where the bytes are no such stream.
std::optional<std::string> decompress_lzf(std::string_view compressed, size_t size);

}  // namespace kinloop
