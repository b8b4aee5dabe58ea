#include "tools/calibration/board/board.hpp"

#include <algorithm>
#include <charconv>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kCharuco = "charuco:";

/// Parses "5x7"; zeros on failure.
std::pair<int, int> parse_size(std::string_view text) {
  const auto number = [](std::string_view digits) {
    int value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() ? value : 0;
  };
  const size_t times = text.find('x');
  if (times == std::string_view::npos) return {0, 0};
  return {number(text.substr(0, times)), number(text.substr(times + 1))};
}

/// Rejects squares of a metre and more, which were probably given in millimetres (small numbers: in
/// centimetres).
void require_metres(double square) {
  constexpr double kMaxCount = 1, kMinMm = 10;
  if (square < kMaxCount) return;
  const auto [unit, per_metre] = square < kMinMm ? std::pair("cm", 100) : std::pair("mm", 1000);
  throw UsageError(
      fmt::format("--square {0:g}: must be in metres; {0:g} {1} is {2:g}", square, unit, square / per_metre));
}

}  // namespace

std::vector<Eigen::Vector2d> Board::corners_m() const {
  std::vector<Eigen::Vector2d> corners;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) corners.emplace_back(column * square_m, row * square_m);
  }
  return corners;
}

std::string to_text(const Board& board) {
  if (!board.has_markers()) return fmt::format("a board of {} x {} inner corners", board.columns, board.rows);
  return fmt::format("six corners of a board of {} x {} squares with markers of {}", board.columns + 1,
                     board.rows + 1, board.dictionary);
}

Board parse_board(std::string_view text, double square_m, double marker_m) {
  Board board;
  board.square_m = square_m;
  if (text.starts_with(kCharuco)) {
    const std::string_view of_board = text.substr(kCharuco.size());
    const size_t colon = std::min(of_board.find(':'), of_board.size());
    std::tie(board.columns, board.rows) = parse_size(of_board.substr(0, colon));
    --board.columns, --board.rows;  // the corners lie between squares
    board.dictionary = of_board.substr(std::min(colon + 1, of_board.size()));
    board.marker_m = marker_m;
  } else {
    std::tie(board.columns, board.rows) = parse_size(text);
  }
  constexpr int kMinCount = 3, kMaxCount = 100;
  const bool size_fits =
      std::min(board.columns, board.rows) >= kMinCount && std::max(board.columns, board.rows) <= kMaxCount;
  if (!size_fits || (text.starts_with(kCharuco) && !board.has_markers())) {
    throw UsageError(fmt::format(
        "--board: '{}' is not a board; specify the inner corners of a chessboard, e.g. 5x7 (at least "
        "3x3), or the squares and dictionary of a ChArUco board, e.g. charuco:7x5:DICT_4X4_50",
        text));
  }
  if (!(square_m > 0)) throw UsageError("--square: must be the side of a square in metres, e.g. 0.03");
  require_metres(square_m);
  if (board.has_markers() && !(marker_m > 0 && marker_m < square_m)) {
    throw UsageError("--marker: must be the side of a ChArUco marker in metres, less than --square");
  }
  return board;
}

BoardView rotated_180(const BoardView& view, const Board& board) {
  const Eigen::Vector2d far_corner((board.columns - 1) * board.square_m, (board.rows - 1) * board.square_m);
  BoardView turned = view;
  for (auto& point : turned.board_m) point = far_corner - point;
  return turned;
}

}  // namespace kinloop
