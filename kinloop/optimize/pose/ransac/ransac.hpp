#pragma once
// Helpers shared by the RANSAC estimators (Fischler and Bolles 1981).

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "kinloop/core/random.hpp"

namespace kinloop {

/// Returns the number of samples needed to draw one of only inliers with probability `confidence`.
inline double required_samples(int inliers, size_t total, uint32_t sample_size, double confidence) {
  const double share = static_cast<double>(inliers) / static_cast<double>(total);
  const double clean = std::pow(share, static_cast<double>(sample_size));
  if (clean >= 1) return 0;
  const double log_contaminated = std::log1p(-clean);
  return log_contaminated < 0 ? std::log1p(-confidence) / log_contaminated
                              : std::numeric_limits<double>::infinity();
}

/// Returns `size` distinct elements of `members`, which must have at least as many.
inline std::vector<uint32_t> draw_sample(Random& random, const std::vector<uint32_t>& members,
                                         uint32_t size) {
  std::vector<uint32_t> sample =
      sample_without_replacement(random, static_cast<uint32_t>(members.size()), size);
  for (uint32_t& s : sample) s = members[s];
  return sample;
}

}  // namespace kinloop
