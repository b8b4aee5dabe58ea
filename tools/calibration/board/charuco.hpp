#pragma once
// In: a grey image. Out: the corners of a fully or partly visible ChArUco board, via OpenCV's aruco (optional
// dependency).

#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/calibration/board/board.hpp"

namespace kinloop {

/// Returns whether this build supports ChArUco boards.
bool charuco_available();

/// Throws UsageError unless this build supports ChArUco, the board's dictionary exists and has enough
/// markers.
void require_charuco(const Board& board);

/// Board corners by their index in `Board::corners_m`, accurate to about a pixel. Each was identified by an
/// adjacent marker, so part of the board suffices. Empty if there are too few or all are collinear.
struct DetectedCorners {
  std::vector<int> corner_ids;
  std::vector<cv::Point2f> pixels;
};
DetectedCorners find_charuco(const cv::Mat& gray, const Board& board);

}  // namespace kinloop
