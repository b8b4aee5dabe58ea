#pragma once
// The ORB descriptor (Rublee et al. 2011): 256 comparisons of a smoothed image around a corner, at positions
// rotated by its orientation.

#include <array>
#include <cstddef>
#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// A rotation in the image.
struct ImageRotation {
  float cosine = 1, sine = 0;
};

constexpr int kBriefMarginPx = 18;  ///< distance from the corner up to which pixels are compared

/// Writes the 32-byte descriptor of the corner at (x, y), at least kBriefMarginPx from the edge.
/// Bit-identical to cv::ORB on the same smoothed image.
void describe_corner(const cv::Mat& blurred, int x, int y, float angle_deg, uint8_t* descriptor);

constexpr std::size_t kBriefTests = 256;

/// The pixel pairs that the descriptor compares: bit i is set if the first pixel of pair i is darker than the
/// second. Integer coordinates relative to the corner, before rotation.
struct BriefPattern {
  std::array<float, kBriefTests> first_x, first_y, second_x, second_y;
};

/// The pattern that Rublee et al. 2011 learned for high variance and low correlation of the bits.
const BriefPattern& brief_pattern();

}  // namespace kinloop
