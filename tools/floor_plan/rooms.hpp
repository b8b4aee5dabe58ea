#pragma once
// In: lines on which walls may stand, and the space seen free. Out: the outlines of rooms.

#include <span>
#include <vector>

#include "tools/floor_plan/free_space.hpp"
#include "tools/floor_plan/wall_lines.hpp"

namespace kinloop {

/// A straight piece of a room's outline.
struct RoomSide {
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
  PlanLine line;        ///< the room is on the side of its normal
  double observed = 0;  ///< share of its length at which surface was observed
};

/// An outline: the outer one of a room counterclockwise, or that of what stands in it clockwise. A side ends
/// where the next begins.
using RoomOutline = std::vector<RoomSide>;

/// Returns the signed area of an outline, positive if it is counterclockwise.
double area_m2(const RoomOutline& outline);

struct RoomShape {
  RoomOutline outer;
  std::vector<RoomOutline> inner;  ///< columns, and blocks of walls

  [[nodiscard]] double area_m2() const;
};

/// Divides the plan along the lines and labels each cell as inside or outside: a cut of least cost (Boykov
/// and Kolmogorov 2004) between the cells that were seen free and the others, which prefers to run where
/// surface was observed (Oesau et al. 2014) as high as walls, see WallLine::least_top_m. Cells inside are one
/// room unless such surface parts them. `free_space`: 8UC1, 255 = seen free at some height. Rooms in order of
/// their area, the largest first.
std::vector<RoomShape> find_rooms(std::span<const WallLine> walls, const cv::Mat& free_space,
                                  const PlanGrid& grid);

}  // namespace kinloop
