#pragma once
// Limits of decoders, so that a damaged header cannot ask for absurd amounts of memory.

#include <cstdint>

namespace kinloop {

constexpr uint32_t kMaxPngSide_px = 1U << 15;
constexpr uint64_t kMaxDecodedPixels = 1U << 26;  ///< 67 million, twice those of an 8K camera
constexpr uint64_t kMaxEncodedBytes = 1U << 28;
constexpr uint64_t kMaxInflation = 1032;  ///< the highest ratio of any deflated stream

}  // namespace kinloop
