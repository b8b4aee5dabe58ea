#pragma once
// In: lines. Out: the cells into which they divide a rectangle (de Berg et al., Computational Geometry, ch.
// 8).

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "tools/floor_plan/wall_lines.hpp"

namespace kinloop {

/// A side of a cell, from `from_m` to the next one's.
struct CellSide {
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
  std::optional<size_t> line;      ///< on which it lies; unset: the border of the rectangle
  std::optional<size_t> neighbor;  ///< the cell beyond
};

/// A convex cell, counterclockwise.
struct PlanCell {
  std::vector<CellSide> sides;

  /// Returns where side `i` ends.
  [[nodiscard]] const Eigen::Vector2d& end_m(size_t i) const { return sides[(i + 1) % sides.size()].from_m; }
};

/// Returns the cells. Lines that hardly differ leave slivers; give each only once.
std::vector<PlanCell> arrange(std::span<const PlanLine> lines, const Eigen::AlignedBox2d& rectangle);

}  // namespace kinloop
