#pragma once
// In: an image and the board in it. Out: how sharp it is.

#include <opencv2/core/mat.hpp>

#include "tools/calibration/board.hpp"

namespace kinloop {

/// Over how many pixels black turns into white at the board's edges, in the middle of all corners: 2 at a
/// perfect step, 2.5 sigma where the image is blurred by sigma.
double edge_width_px(const cv::Mat& image, const BoardView& view);

}  // namespace kinloop
