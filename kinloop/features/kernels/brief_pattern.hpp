#pragma once

#include <array>
#include <cstddef>

namespace kinloop {

constexpr std::size_t kBriefTests = 256;

/// The pixels that the descriptor compares: bit i is set where the first of pair i is darker than the second.
/// Coordinates are relative to the corner, before it is turned; whole numbers.
struct BriefPattern {
  std::array<float, kBriefTests> first_x, first_y, second_x, second_y;
};

/// The pattern that Rublee et al. 2011 learned so that the bits vary much and together little.
const BriefPattern& brief_pattern();

}  // namespace kinloop
