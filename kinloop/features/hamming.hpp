#pragma once
// Hamming distance of binary descriptors.

#include <bit>
#include <cstdint>
#include <cstring>

namespace kinloop {

constexpr int kOrbBytes = 32;  ///< an ORB descriptor has 256 bits

/// Returns the number of differing bits of two ORB descriptors (32 bytes each).
inline int hamming_distance(const uint8_t* a, const uint8_t* b) {
  int distance = 0;
  for (int i = 0; i < kOrbBytes; i += 8) {
    uint64_t wa, wb;
    std::memcpy(&wa, a + i, sizeof wa);
    std::memcpy(&wb, b + i, sizeof wb);
    distance += std::popcount(wa ^ wb);
  }
  return distance;
}

}  // namespace kinloop

/// Marks a function dominated by Hamming distances: it is also compiled for CPUs with a popcount instruction
/// and dispatched at run time. Integer arithmetic, so the results are identical.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define KINLOOP_POPCOUNT_CLONES __attribute__((target_clones("default", "popcnt", "avx2")))
#else
#define KINLOOP_POPCOUNT_CLONES
#endif
