#pragma once

#include <array>
#include <cstddef>

namespace kinloop {

constexpr std::size_t kBriefTests = 256;

/// The pixel pairs that the descriptor compares: bit i is set if the first pixel of pair i is darker than the
/// second. Integer coordinates relative to the corner, before rotation.
struct BriefPattern {
  std::array<float, kBriefTests> first_x, first_y, second_x, second_y;
};

/// The pattern that Rublee et al. 2011 learned for high variance and low correlation of the bits.
const BriefPattern& brief_pattern();

}  // namespace kinloop
