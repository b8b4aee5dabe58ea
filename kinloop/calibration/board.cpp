#include "kinloop/calibration/board.hpp"

#include <charconv>

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"

namespace kinloop {

std::vector<Eigen::Vector2d> Board::corners_m() const {
  std::vector<Eigen::Vector2d> corners;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) corners.emplace_back(column * square_m, row * square_m);
  }
  return corners;
}

Board parse_board(std::string_view text, double square_m) {
  constexpr int kFewest = 3, kMost = 100;
  const auto number = [](std::string_view digits) {
    int value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() ? value : 0;
  };
  const size_t times = text.find('x');
  Board board;
  board.square_m = square_m;
  if (times != std::string_view::npos) {
    board.columns = number(text.substr(0, times));
    board.rows = number(text.substr(times + 1));
  }
  if (board.columns < kFewest || board.rows < kFewest || board.columns > kMost || board.rows > kMost) {
    throw UsageError(
        fmt::format("--board: '{}' is not a board; give its inner corners, e.g. 5x7 (at least 3x3)", text));
  }
  if (!(square_m > 0)) throw UsageError("--square: the side of a square in metres, e.g. 0.03");
  return board;
}

BoardView turned_half(const BoardView& view, const Board& board) {
  const Eigen::Vector2d far_corner((board.columns - 1) * board.square_m, (board.rows - 1) * board.square_m);
  BoardView turned = view;
  for (auto& point : turned.board_m) point = far_corner - point;
  return turned;
}

}  // namespace kinloop
