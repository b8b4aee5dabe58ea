#pragma once
// In: a compressed block of a bag, and its announced size. Out: its content.

#include <cstdint>
#include <string_view>
#include <vector>

#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {

/// No message or chunk may be larger; more means a damaged length.
constexpr uint64_t kMaxBlockBytes = uint64_t{1} << 29;

/// Decompresses the first `size` bytes of "lz4" (frame format), "zstd" or "bz2". Throws InputError for
/// another compression, data that are damaged or shorter, and a size above kMaxBlockBytes. Memory grows with
/// what has really been decompressed.
std::vector<uint8_t> decompressed(std::string_view compression, Bytes data, uint64_t size);

/// Returns whether the data begin like a zstd frame.
bool is_zstd(Bytes data);

/// Same for a zstd frame that states its size itself.
std::vector<uint8_t> decompressed_zstd_message(Bytes data);

/// CRC-32 as in zlib.
uint32_t crc32(Bytes data);

}  // namespace kinloop
