#pragma once
// The ORB descriptor (Rublee et al. 2011): 256 comparisons of a smoothed image around a corner, at positions
// rotated by its orientation.

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kBriefMarginPx = 18;  ///< distance from the corner up to which pixels are compared

/// Writes the 32-byte descriptor of the corner at (x, y), at least kBriefMarginPx from the edge.
/// Bit-identical to cv::ORB on the same smoothed image.
void describe_corner(const cv::Mat& blurred, int x, int y, float angle_deg, uint8_t* descriptor);

}  // namespace kinloop
