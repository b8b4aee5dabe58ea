#pragma once
// Random deviates from the bits of one word: cheap enough for every pixel.

#include <cstdint>

namespace kinloop::sim {

/// Sum of the four 16-bit parts of a word as a deviate of mean 0 and variance 1: close to normal, and cheap
/// (Irwin and Hall 1927).
inline double approximate_normal(uint64_t bits) {
  const uint64_t sum = (bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48);
  constexpr double kMean = 2 * 65535.0;
  constexpr double kInverseSigma = 1.7320508075688772 / 65536;  // sqrt(12 / 4) / range
  return (static_cast<double>(sum) - kMean) * kInverseSigma;
}

/// Uniform in [0, 1).
inline double uniform(uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

}  // namespace kinloop::sim
