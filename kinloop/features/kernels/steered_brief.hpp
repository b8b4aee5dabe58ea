#pragma once
// The descriptor of ORB (Rublee et al. 2011): 256 comparisons of a smoothed image around a corner, at places
// that turn with its direction.

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kBriefMarginPx = 18;  ///< how far from the corner pixels are compared

/// Writes the 32 bytes that describe the corner at (x, y), at least kBriefMarginPx from the edge. The same
/// bits as cv::ORB gives on the same smoothed image.
void describe_corner(const cv::Mat& blurred, int x, int y, float angle_deg, uint8_t* descriptor);

}  // namespace kinloop
