#pragma once
// In: images of a chessboard. Out: its number of inner corners, in case the user miscounted.

#include <filesystem>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/calibration/board.hpp"

namespace kinloop {

/// Inner corners of a chessboard; rows and columns are interchangeable.
struct BoardSize {
  int shorter = 0, longer = 0;

  auto operator<=>(const BoardSize&) const = default;  // NOLINT(modernize-use-nullptr): as in ids.hpp
};

/// Detects the size of the largest chessboard in an 8-bit grey image; nullopt if there is none. Takes about
/// 0.15 s for any image size, since the image is scaled first.
std::optional<BoardSize> detect_board_size(const cv::Mat& gray);

/// Detects the size of the board in the images if it differs from `board`, judged by a few images spread over
/// all. nullopt if they disagree, and for boards with markers.
std::optional<BoardSize> detect_other_board_size(const std::vector<std::filesystem::path>& stills,
                                                 const Board& board, int threads);

}  // namespace kinloop
