#pragma once
// Selection of the pixels of a depth image that lie on a surface. Pixels at depth edges are excluded, since
// they often average foreground and background.

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "dense/options.hpp"

namespace kinloop {

/// Depth is compared with that of pixels at this distance: one pixel further would miss thin objects; one
/// pixel nearer would mistake disparity steps at 4 m for edges. Pixels nearer to the border are not judged.
constexpr int kDepthMarginPx = 2;

/// Marks the pixels of a row (at least kDepthMarginPx from the border) whose depth is in range and close to
/// that of their four neighbours; unknown neighbours are ignored. `usable` has one entry per column.
void mark_usable(const cv::Mat& depth_m, int row, double focal_px, const DepthLimits& limits,
                 uint8_t* usable);

/// Returns 8UC1, nonzero where a pixel is usable.
cv::Mat usable_pixels(const cv::Mat& depth_m, double focal_px, const DepthLimits& limits);

}  // namespace kinloop
