#pragma once
// In: sizes of rectangles. Out: places for them in a strip, without overlap.

#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

namespace kinloop {

/// Places in a strip.
struct PackedRectangles {
  std::vector<cv::Point> corners;  ///< upper left, in the order of the sizes
  int height = 0;                  ///< of the strip that they take
};

/// Packs rectangles into a strip of this width, which grows downwards: from the highest rectangle on, each
/// goes where its lower side is uppermost ("skyline"; Jylanki, "A Thousand Ways to Pack the Bin", 2010).
/// nullopt if one is wider than the strip.
std::optional<PackedRectangles> pack_rectangles(std::span<const cv::Size> sizes, int width);

}  // namespace kinloop
