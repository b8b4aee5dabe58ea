#pragma once
// In: points of upright surfaces, seen from above. Out: the lines on which walls may stand.

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// The z component of the cross product.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A point of an upright surface in the frame of the plan.
struct UprightPoint {
  Eigen::Vector2d p_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit, towards the cameras
  double z_m = 0;                                     ///< above the floor
};

/// A line of the plan; points p of it fulfil normal . p = offset_m.
struct PlanLine {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit, towards the side from which it was seen
  double offset_m = 0;

  [[nodiscard]] double distance_m(const Eigen::Vector2d& p_m) const { return normal.dot(p_m) - offset_m; }

  /// Returns the direction in which positions along the line grow: the seen side is to the left.
  [[nodiscard]] Eigen::Vector2d along() const { return {normal.y(), -normal.x()}; }

  /// Returns the point at position `s_m` along the line.
  [[nodiscard]] Eigen::Vector2d at(double s_m) const { return offset_m * normal + s_m * along(); }
};

/// The surface observed on a line at one position.
struct WallColumn {
  double observed_m = 0;  ///< sum of the heights at which there is surface
  double top_m = 0;       ///< its largest height above the floor
};

/// Surface of at least this height counts, m.
constexpr double kLeastObserved_m = 0.3;

/// A candidate for walls.
struct WallLine {
  PlanLine line;
  double area_m2 = 0;               ///< of the surface on it
  double first_m = 0;               ///< position of the first column
  std::vector<WallColumn> columns;  ///< every kWallStep_m
  double least_top_m = 0;           ///< surface that reaches this height is a wall, lower one furniture

  /// Returns the share of the positions from `from_m` to `to_m` at which there is surface that reaches the
  /// height `reaching_m`.
  [[nodiscard]] double support(double from_m, double to_m, double reaching_m = 0) const;

  /// Returns whether a piece is hidden between surfaces of the line, or continues one: at most 1 m from it.
  [[nodiscard]] bool continues(double from_m, double to_m) const;
};

/// Step of positions along walls.
constexpr double kWallStep_m = 0.05;

/// Fits lines to the points, the largest surfaces first. Lines nearly parallel to one of two perpendicular
/// directions that most surfaces have are made parallel to it. `point_area_m2`: surface area that a point
/// represents.
std::vector<WallLine> find_wall_lines(std::span<const UprightPoint> points, double point_area_m2);

/// Drops the lines of what hangs on a wall, and says how high the surface of the others must reach to be a
/// wall: nearly as high as any that was seen; where it stands before a larger one, to the ceiling, if any was
/// seen.
std::vector<WallLine> without_furniture(std::vector<WallLine> lines, double highest_m,
                                        std::optional<double> ceiling_m);

}  // namespace kinloop
