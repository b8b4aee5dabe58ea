#pragma once
// What the RANSAC estimators share (Fischler and Bolles 1981).

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "kinloop/base/random.hpp"

namespace kinloop {

/// How many samples make it likely (with probability `confidence`) that one of them held inliers alone.
inline double required_samples(int inliers, size_t total, uint32_t sample_size, double confidence) {
  const double share = static_cast<double>(inliers) / static_cast<double>(total);
  const double clean = std::pow(share, static_cast<double>(sample_size));
  if (clean >= 1) return 0;
  const double log_contaminated = std::log1p(-clean);
  return log_contaminated < 0 ? std::log1p(-confidence) / log_contaminated
                              : std::numeric_limits<double>::infinity();
}

/// `size` different members of `members`, which must have as many.
inline std::vector<uint32_t> draw_sample(Random& random, const std::vector<uint32_t>& members,
                                         uint32_t size) {
  std::vector<uint32_t> sample =
      sample_without_replacement(random, static_cast<uint32_t>(members.size()), size);
  for (uint32_t& s : sample) s = members[s];
  return sample;
}

}  // namespace kinloop
