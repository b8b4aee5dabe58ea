#pragma once
// Which pixels of a depth image tell where a surface is: not those at the edge of something, which are often
// a mean of before and behind.

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Which depth to trust.
struct DepthLimits {
  double min_depth_m = 0, max_depth_m = 0;
  double max_incidence_deg = 0;  ///< of a surface, from facing the ray
};

/// Depth is compared with that of pixels this far away: one pixel further would miss thin things, one nearer
/// would take the steps of the disparity at 4 m for edges. Pixels nearer to the border are not judged.
constexpr int kDepthMarginPx = 2;

/// Marks the pixels of a row (at least kDepthMarginPx from the border) whose depth is in range and close to
/// that of the four pixels around; unknown neighbours say nothing. `usable` has a place per column.
void mark_usable(const cv::Mat& depth_m, int row, double focal_px, const DepthLimits& limits,
                 uint8_t* usable);

/// 8UC1, not 0 where a pixel is usable.
cv::Mat usable_pixels(const cv::Mat& depth_m, double focal_px, const DepthLimits& limits);

}  // namespace kinloop
