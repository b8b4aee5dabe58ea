#pragma once
// Seeded random numbers. The seed is derived from the purpose (`hash(seed, frame id)`), so that results do
// not depend on the order in which jobs run.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "kinloop/core/errors.hpp"

namespace kinloop {

/// Mixes two words into one (the finaliser of SplitMix64, Steele et al. 2014).
constexpr uint64_t hash(uint64_t a, uint64_t b) {
  uint64_t x = a + 0x9e3779b97f4a7c15ULL * (b + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// SplitMix64: small, fast, and identical with every standard library.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(hash(seed, 0)) {}

  uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return hash(state_, 0);
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform in {0, ..., count - 1}.
  uint32_t index(uint32_t count) { return static_cast<uint32_t>(((next() >> 32) * count) >> 32); }

  /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
  double gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  uint64_t state_;
};

/// Returns `size` distinct indices below `count` in random order; `size` must not exceed `count`.
inline std::vector<uint32_t> sample_without_replacement(Random& random, uint32_t count, uint32_t size) {
  require(size <= count, "sample_without_replacement: size exceeds count");
  std::vector<uint32_t> chosen;
  while (chosen.size() < size) {
    const uint32_t candidate = random.index(count);
    bool is_new = true;
    for (const uint32_t other : chosen) is_new = is_new && other != candidate;
    if (is_new) chosen.push_back(candidate);
  }
  return chosen;
}

}  // namespace kinloop
