#pragma once
// The orientation of a corner.

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kDiscRadius = 15;    ///< radius of the disc whose centroid gives the orientation, px
constexpr int kDiscMarginPx = 16;  ///< distance from the corner up to which pixels are read

/// First moments of the intensities of a disc around a pixel at least kDiscMarginPx from the edge.
struct DiscMoments {
  int m10 = 0;  ///< sum of x * intensity, x to the right of the centre
  int m01 = 0;  ///< sum of y * intensity, y downwards

  bool operator==(const DiscMoments&) const = default;
};

DiscMoments disc_moments(const cv::Mat& image, int x, int y);

/// Direction from a corner to the intensity centroid of the disc around it, degrees in [0, 360) (Rosin 1999;
/// Eq. (3) of Rublee et al. 2011).
float orientation_deg(const cv::Mat& image, int x, int y);

}  // namespace kinloop
