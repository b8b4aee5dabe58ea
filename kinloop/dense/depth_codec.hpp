#pragma once
// Depth images made small without loss, fast enough to be done while tracking.

#include <cstdint>
#include <span>
#include <vector>

namespace kinloop {

/// Packs depth values, 0 = unknown, as in Wilson 2017, "Fast Lossless Depth Image Compression": runs of zeros
/// and differences of successive values, as numbers of three bits a piece.
std::vector<uint8_t> pack_depth(std::span<const uint16_t> values);

/// The `count` values that were packed. Throws std::logic_error when the bytes are not what `pack_depth`
/// gave.
std::vector<uint16_t> unpack_depth(std::span<const uint8_t> bytes, size_t count);

}  // namespace kinloop
