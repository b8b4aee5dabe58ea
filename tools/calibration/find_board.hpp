#pragma once
// In: an image. Out: the corners of the board in it, to a fraction of a pixel.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/progress.hpp"
#include "tools/calibration/board.hpp"

namespace kinloop {

/// An 8-bit grey image to look at and to find corners in: colour turned grey; 16-bit infrared, whose light
/// falls with the square of the distance and saturates nearby, by the square root between its percentiles.
cv::Mat to_gray_8bit(const cv::Mat& image);

/// The board in an 8- or 16-bit image; nothing where it is not wholly in view. Of a ChArUco board a part is
/// enough.
std::optional<BoardView> find_board(const cv::Mat& image, const Board& board);

/// What a folder of stills shows.
struct BoardSearch {
  std::vector<BoardView> views;            ///< in order of their names
  std::vector<std::string> without_board;  ///< images without a board
};

/// The images (PNG, JPEG) of a folder whose names end with `ending` (e.g. "_ir.png"; all where empty), in
/// order of name. Throws InputError when there are none.
std::vector<std::filesystem::path> list_stills(const std::filesystem::path& folder,
                                               const std::string& ending = {});

/// Reads an image file as it is: 8 or 16 bits, any number of channels. Throws InputError naming it.
cv::Mat read_still(const std::filesystem::path& path);

/// Looks for the board in all of them, on up to `threads` threads. Throws InputError when images differ in
/// size, or none shows the board; at once, naming its size, where a few of them agree on a board of another
/// size.
BoardSearch find_boards(const std::vector<std::filesystem::path>& stills, const Board& board, int threads,
                        const Progress& progress = {});

}  // namespace kinloop
