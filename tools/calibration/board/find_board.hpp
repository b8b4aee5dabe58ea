#pragma once
// In: an image. Out: the subpixel corners of the board.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/progress.hpp"
#include "tools/calibration/board/board.hpp"

namespace kinloop {

/// Converts to 8-bit grey for display and detection: colour to grey; 16-bit infrared, which falls with the
/// square of the distance and saturates close up, by the square root between its percentiles.
cv::Mat to_gray_8bit(const cv::Mat& image);

/// Detects the board in an 8- or 16-bit image; nullopt if it is not completely visible. Part of a ChArUco
/// board suffices.
std::optional<BoardView> find_board(const cv::Mat& image, const Board& board);

/// Board detections in a folder of images.
struct BoardSearch {
  std::vector<BoardView> views;            ///< sorted by file name
  std::vector<std::string> without_board;  ///< images without a board
};

/// Lists the images (PNG, JPEG) of a folder whose names end with `ending` (e.g. "_ir.png"; all if empty),
/// sorted by name. Throws InputError if there are none.
std::vector<std::filesystem::path> list_stills(const std::filesystem::path& folder,
                                               const std::string& ending = {});

/// Reads an image file unconverted: 8 or 16 bits, any number of channels. Throws InputError naming it.
cv::Mat read_still(const std::filesystem::path& path);

/// Detects the board in all images on up to `threads` threads. Throws InputError if images differ in size or
/// none shows the board; early, naming the size, if several images agree on a board of another size.
BoardSearch find_boards(const std::vector<std::filesystem::path>& stills, const Board& board, int threads,
                        const Progress& progress = {});

/// Inner corners of a chessboard; rows and columns are interchangeable.
struct BoardSize {
  int shorter = 0, longer = 0;

  auto operator<=>(const BoardSize&) const = default;  // NOLINT(modernize-use-nullptr): as in ids.hpp
};

/// Detects the size of the largest chessboard in an 8-bit grey image; nullopt if there is none. Takes about
/// 0.15 s for any image size, since the image is scaled first.
std::optional<BoardSize> detect_board_size(const cv::Mat& gray);

/// Detects the size of the board in the images, in case the user miscounted, if it differs from `board`,
/// judged by a few images spread over all. nullopt if they disagree, and for boards with markers.
std::optional<BoardSize> detect_other_board_size(const std::vector<std::filesystem::path>& stills,
                                                 const Board& board, int threads);

}  // namespace kinloop
