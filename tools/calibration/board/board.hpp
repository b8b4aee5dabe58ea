#pragma once
// The calibration board and its detections.

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// A chessboard given by its inner corners, or a ChArUco board, whose markers in the white squares identify
/// each corner. Its frame: x along a row, y along a column, z = 0 on the board.
struct Board {
  int columns = 0;         ///< inner corners per row
  int rows = 0;            ///< inner corners per column
  double square_m = 0;     ///< side of a square
  std::string dictionary;  ///< marker dictionary, OpenCV's name; empty: a plain chessboard
  double marker_m = 0;     ///< side of a marker

  [[nodiscard]] bool has_markers() const { return !dictionary.empty(); }

  /// Returns the corners row by row, as OpenCV's detector lists them.
  [[nodiscard]] std::vector<Eigen::Vector2d> corners_m() const;

  /// Returns whether a rotation by 180 degrees leaves the board unchanged, so that its orientation in an
  /// image is ambiguous.
  [[nodiscard]] bool has_180_degree_symmetry() const { return !has_markers() && (columns + rows) % 2 == 0; }
};

/// Describes the board for users: "a board of 5 x 7 inner corners".
std::string to_text(const Board& board);

/// Parses "5x7" (inner corners) or "charuco:7x5:DICT_4X4_50" (squares and dictionary). Throws UsageError for
/// anything that is not a board of at least 3 x 3 inner corners, and for markers that do not fit into
/// squares.
Board parse_board(std::string_view text, double square_m, double marker_m = 0);

/// A detection of the board in an image.
struct BoardView {
  std::string name;                      ///< name of the image
  int width = 0, height = 0;             ///< px, size of the image
  std::vector<Eigen::Vector2d> board_m;  ///< points on the board
  std::vector<Eigen::Vector2d> pixels;   ///< the same points in the image, distorted
};

/// Returns the same detection with the board rotated by 180 degrees.
BoardView rotated_180(const BoardView& view, const Board& board);

}  // namespace kinloop
