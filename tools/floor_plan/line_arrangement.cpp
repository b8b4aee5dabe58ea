#include <cmath>
#include <map>
#include <utility>

#include "tools/floor_plan/rooms.hpp"

namespace kinloop {
namespace {

constexpr double kSame_m = 1e-6;  ///< corners nearer than this are one

PlanCell cell_of(const Eigen::AlignedBox2d& box) {
  PlanCell cell;
  for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                            Eigen::AlignedBox2d::TopRight, Eigen::AlignedBox2d::TopLeft})
    cell.sides.push_back({box.corner(corner), {}, {}});
  return cell;
}

/// Returns the part of a convex cell on one side of a line: where `sign` times the distance is positive.
PlanCell part_of(const PlanCell& cell, const PlanLine& line, size_t index, double sign) {
  PlanCell part;
  for (size_t i = 0; i < cell.sides.size(); ++i) {
    const CellSide& side = cell.sides[i];
    const double a = sign * line.distance_m(side.from_m), b = sign * line.distance_m(cell.end_m(i));
    const bool from_inside = a > kSame_m, end_inside = b > kSame_m;
    const bool from_on = std::abs(a) <= kSame_m;
    if (from_inside || (from_on && end_inside)) part.sides.push_back(side);
    if (from_on && !end_inside) part.sides.push_back({side.from_m, index, {}});
    if ((from_inside && b < -kSame_m) || (a < -kSame_m && end_inside)) {
      const Eigen::Vector2d crossing = side.from_m + a / (a - b) * (cell.end_m(i) - side.from_m);
      part.sides.push_back({crossing, from_inside ? std::optional(index) : side.line, {}});
    }
  }
  return part;
}

bool is_crossed(const PlanCell& cell, const PlanLine& line) {
  bool left = false, right = false;
  for (const CellSide& side : cell.sides) {
    const double distance_m = line.distance_m(side.from_m);
    left = left || distance_m > kSame_m;
    right = right || distance_m < -kSame_m;
  }
  return left && right;
}

/// Every line divides all cells that it crosses, so that the two sides of cells that meet on a line have the
/// same ends.
void connect(std::vector<PlanCell>& cells, std::span<const PlanLine> lines) {
  constexpr double kStep_m = 1e-4;
  std::map<std::pair<size_t, long>, std::pair<size_t, size_t>> open;  // line and middle -> cell and side
  for (size_t c = 0; c < cells.size(); ++c) {
    for (size_t i = 0; i < cells[c].sides.size(); ++i) {
      CellSide& side = cells[c].sides[i];
      if (!side.line) continue;
      const Eigen::Vector2d middle = (side.from_m + cells[c].end_m(i)) / 2;
      const long at = std::lround(lines[*side.line].along().dot(middle) / kStep_m);
      for (const long near : {at, at - 1, at + 1}) {
        const auto found = open.find({*side.line, near});
        if (found == open.end() || found->second.first == c) continue;
        const auto [other, other_side] = found->second;
        side.neighbor = other;
        cells[other].sides[other_side].neighbor = c;
        open.erase(found);
        break;
      }
      if (!side.neighbor) open[{*side.line, at}] = {c, i};
    }
  }
}

}  // namespace

std::vector<PlanCell> arrange(std::span<const PlanLine> lines, const Eigen::AlignedBox2d& rectangle) {
  std::vector<PlanCell> cells{cell_of(rectangle)};
  for (size_t index = 0; index < lines.size(); ++index) {
    std::vector<PlanCell> divided;
    for (PlanCell& cell : cells) {
      if (!is_crossed(cell, lines[index])) {
        divided.push_back(std::move(cell));
        continue;
      }
      divided.push_back(part_of(cell, lines[index], index, 1));
      divided.push_back(part_of(cell, lines[index], index, -1));
    }
    cells = std::move(divided);
  }
  connect(cells, lines);
  return cells;
}

}  // namespace kinloop
