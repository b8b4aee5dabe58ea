#pragma once
// In: lines on which walls may stand, and posed depth images. Out: the space seen free, and the outlines of
// rooms.

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"
#include "kinloop/core/progress.hpp"
#include "tools/floor_plan/wall_lines.hpp"

namespace kinloop {

// Where on the floor plan rays passed, at which heights.

/// A rectangle of the plan, divided into square cells.
struct PlanGrid {
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< corner of cell (0, 0), of the smallest x and y
  double cell_m = 0.025;
  cv::Size size = {};  ///< cells

  /// Returns the cell that contains `p_m`; it may be outside.
  [[nodiscard]] cv::Point cell(const Eigen::Vector2d& p_m) const;

  /// Returns the middle of a cell.
  [[nodiscard]] Eigen::Vector2d middle_m(const cv::Point& cell) const;

  /// Returns whether the cell lies in the grid.
  [[nodiscard]] bool contains(const cv::Point& cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < size.width && cell.y < size.height;
  }
};

/// Heights above the floor, metres.
struct HeightRange {
  double low_m = 0, high_m = 0;

  [[nodiscard]] bool contains(double z_m) const { return z_m >= low_m && z_m < high_m; }
};

/// The depth images of a map in the frame of the plan: z up, the floor at 0.
struct PlanViews {
  const ImageStore& images;
  std::span<const PosedImage> views;
  const PinholeCamera& camera;
  SE3 T_plan_world;
  DepthLimits limits;
};

/// Returns for each range of heights an image of the grid, 8UC1: 255 = at least two views, or the only one,
/// saw through some of that range.
std::vector<cv::Mat> observed_free_space(const PlanViews& views, const PlanGrid& grid,
                                         std::span<const HeightRange> ranges, const Progress& progress);

// The cells into which lines divide a rectangle (de Berg et al., Computational Geometry, ch. 8).

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
