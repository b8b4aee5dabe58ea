#pragma once
// In: stills of a chessboard. Out: how many inner corners it has, for those who counted them wrongly.

#include <filesystem>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/calibration/board.hpp"

namespace kinloop {

/// Inner corners of a chessboard; an image does not tell its rows from its columns.
struct BoardSize {
  int shorter = 0, longer = 0;

  auto operator<=>(const BoardSize&) const = default;  // NOLINT(modernize-use-nullptr): as in ids.hpp
};

/// The size of the largest chessboard that an 8-bit grey image shows; nothing where it shows none. It takes
/// about 0.15 s whatever the image's size, which is reduced first.
std::optional<BoardSize> detect_board_size(const cv::Mat& gray);

/// The size of the board in the stills where it is not `board`: judged by a few of them, spread over all.
/// Nothing where they do not agree, and for boards with markers.
std::optional<BoardSize> detect_other_board_size(const std::vector<std::filesystem::path>& stills,
                                                 const Board& board, int threads);

}  // namespace kinloop
