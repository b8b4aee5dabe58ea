#pragma once
// Fast lossless compression of depth images.

#include <cstdint>
#include <span>
#include <vector>

namespace kinloop {

/// Packs depth values, 0 = unknown, as in Wilson 2017, "Fast Lossless Depth Image Compression": runs of zeros
/// and differences of successive values as variable-length numbers of three bits per nibble.
std::vector<uint8_t> pack_depth(std::span<const uint16_t> values);

/// Unpacks `count` values. Throws InputError if the bytes are damaged, or of fewer or more values.
std::vector<uint16_t> unpack_depth(std::span<const uint8_t> bytes, size_t count);

}  // namespace kinloop
