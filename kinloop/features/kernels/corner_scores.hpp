#pragma once
// In: a grey image. Out: FAST corners (Rosten and Drummond 2006; 9 of 16 pixels of the circle of radius 3).

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace kinloop {

constexpr int kMinCornerWidth = 32;  ///< images narrower than this inside their border have no corners

/// A corner of an image.
struct RawCorner {
  int x = 0;  ///< where the contrast is greatest, whole pixels
  int y = 0;
  int contrast = 0;  ///< the least difference along the best arc of 9 pixels, grey levels
  float dx = 0;      ///< from there to the peak of the parabola through the neighbours' contrasts, px
  float dy = 0;
};

/// The corners with a contrast above `threshold` that are at least `border` (3 or more) from the edge and
/// strongest among their eight neighbours, in reading order. Of two equal neighbours the first counts.
std::vector<RawCorner> find_corners(const cv::Mat& image, int threshold, int border);

}  // namespace kinloop
