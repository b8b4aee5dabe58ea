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

}  // namespace kinloop
