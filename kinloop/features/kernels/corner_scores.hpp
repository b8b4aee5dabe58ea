#pragma once
// In: a grey image. Out: FAST corners (Rosten and Drummond 2006; 9 of the 16 pixels of a circle of radius 3).

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kMinCornerWidth = 32;  ///< an image whose inner width is smaller has no corners

/// A corner of an image.
struct RawCorner {
  int x = 0;  ///< local maximum of contrast, whole pixels
  int y = 0;
  int contrast = 0;  ///< the smallest difference along the best arc of 9 pixels, grey levels
  float dx = 0;      ///< subpixel offset: peak of the parabola through the neighbours' contrasts, px
  float dy = 0;
};

/// Returns the corners with a contrast above `threshold`, at least `border` (3 or more) pixels from the edge,
/// that are maxima among their eight neighbours, in reading order. Of two equal neighbours the first is kept.
std::vector<RawCorner> find_corners(const cv::Mat& image, int threshold, int border);

// The orientation of a corner.

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
