#pragma once
// In: compressed blocks of TIFF files (TIFF 6.0, sections 9 and 13). Out: their bytes.

#include <cstddef>
#include <string>
#include <string_view>

namespace kinloop {

/// Decodes at most `size` bytes of LZW: codes of 9 to 12 bits, highest bit first. Throws InputError if
/// damaged.
std::string expand_tiff_lzw(std::string_view packed, size_t size);

/// Decodes at most `size` bytes of PackBits. Throws InputError if truncated.
std::string expand_packbits(std::string_view packed, size_t size);

}  // namespace kinloop
