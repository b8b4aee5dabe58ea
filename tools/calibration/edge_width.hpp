#pragma once
// In: an image and its board detection. Out: its sharpness.

#include <opencv2/core/mat.hpp>

#include "tools/calibration/board.hpp"

namespace kinloop {

/// Returns the median width of the board's black-to-white edges in pixels: 2 for a perfect step, 2.5 sigma if
/// the image is blurred by sigma.
double edge_width_px(const cv::Mat& image, const BoardView& view);

}  // namespace kinloop
