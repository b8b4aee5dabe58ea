#pragma once
// The chessboard that a camera is calibrated with, and what an image shows of it.

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// A chessboard by its inner corners, or a ChArUco board: with markers in its white squares, by which each
/// corner is known. Its frame: x along a row, y along a column, z = 0 on the board.
struct Board {
  int columns = 0;         ///< inner corners of a row
  int rows = 0;            ///< inner corners of a column
  double square_m = 0;     ///< side of a square
  std::string dictionary;  ///< of the markers, as OpenCV names it; empty: a plain chessboard
  double marker_m = 0;     ///< side of a marker

  [[nodiscard]] bool has_markers() const { return !dictionary.empty(); }

  /// The corners row by row, as OpenCV's detector lists them.
  [[nodiscard]] std::vector<Eigen::Vector2d> corners_m() const;

  /// Whether the board turned by half a turn looks the same: then an image does not tell which way it is.
  [[nodiscard]] bool has_180_degree_symmetry() const { return !has_markers() && (columns + rows) % 2 == 0; }
};

/// What is looked for, for people: "a board of 5 x 7 inner corners".
std::string to_text(const Board& board);

/// Reads "5x7", inner corners, or "charuco:7x5:DICT_4X4_50", squares and dictionary. Throws UsageError for
/// anything that is not a board of at least 3 x 3 inner corners, and for markers that do not fit into
/// squares.
Board parse_board(std::string_view text, double square_m, double marker_m = 0);

/// Where an image shows which points of the board.
struct BoardView {
  std::string name;                      ///< of the image
  int width = 0, height = 0;             ///< px, of the image
  std::vector<Eigen::Vector2d> board_m;  ///< points on the board
  std::vector<Eigen::Vector2d> pixels;   ///< the same points in the image, with its distortion
};

/// The same view with the board read the other way round.
BoardView rotated_180(const BoardView& view, const Board& board);

}  // namespace kinloop
