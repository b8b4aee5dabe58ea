#pragma once
// The direction of a corner.

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kDiscRadius = 15;    ///< of the disc whose centroid gives the direction, px
constexpr int kDiscMarginPx = 16;  ///< how far from the corner pixels are read

/// First moments of the intensities of a disc around a pixel that is at least kDiscMarginPx from the edge.
struct DiscMoments {
  int m10 = 0;  ///< sum of x * intensity, x from the centre to the right
  int m01 = 0;  ///< sum of y * intensity, y downwards

  bool operator==(const DiscMoments&) const = default;
};

DiscMoments disc_moments(const cv::Mat& image, int x, int y);

/// Direction from a corner to the intensity centroid of the disc around it, degrees in [0, 360) (Rosin 1999;
/// Eq. (3) of Rublee et al. 2011).
float orientation_deg(const cv::Mat& image, int x, int y);

}  // namespace kinloop
