#pragma once
// In: a grey image. Out: the corners of a ChArUco board in it, also of a part of the board. Only where the
// build found OpenCV's aruco.

#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/calibration/board.hpp"

namespace kinloop {

/// Whether this build knows ChArUco boards.
bool charuco_available();

/// Throws UsageError unless this build knows ChArUco boards, the board's dictionary, and the dictionary has
/// enough markers for it.
void require_charuco(const Board& board);

/// Corners of the board, by their place in `Board::corners_m`, to about a pixel. Each has a marker beside it
/// that was read, so that a part of the board is enough. Empty where there are fewer than some, or all in a
/// row.
struct DetectedCorners {
  std::vector<int> corner_ids;
  std::vector<cv::Point2f> pixels;
};
DetectedCorners find_charuco(const cv::Mat& gray, const Board& board);

}  // namespace kinloop
