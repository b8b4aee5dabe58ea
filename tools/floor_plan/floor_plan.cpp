#include "tools/floor_plan/floor_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "tools/floor_plan/openings.hpp"

namespace kinloop {
namespace {

constexpr HeightRange kObjects{0.1, 1.8};
constexpr double kLowestOfWalls_m = 0.3, kBelowCeiling_m = 0.08;

/// Heights of the floor and of the ceiling along z.
struct Levels {
  double floor_m = 0;
  std::optional<double> ceiling_m;
};

/// Returns the mean height of the largest layer near `z_m`.
double layer_near(const std::vector<double>& heights_m, double z_m) {
  constexpr double kReach_m = 0.05;
  std::vector<double> near;
  for (const double height_m : heights_m) {
    if (std::abs(height_m - z_m) < kReach_m) near.push_back(height_m);
  }
  return near.empty() ? z_m : median(near);
}

/// Returns the lowest height at which there is a good share of the surface of the largest layer. `sign` -1:
/// the highest.
std::optional<double> outermost_layer(std::vector<double> heights_m, double sign) {
  constexpr double kBin_m = 0.03, kShare = 0.2;
  if (heights_m.empty()) return std::nullopt;
  const double lowest = *std::min_element(heights_m.begin(), heights_m.end());
  const double highest = *std::max_element(heights_m.begin(), heights_m.end());
  std::vector<double> counts(static_cast<size_t>((highest - lowest) / kBin_m) + 1, 0);
  for (const double z_m : heights_m) ++counts[static_cast<size_t>((z_m - lowest) / kBin_m)];
  const double least = kShare * *std::max_element(counts.begin(), counts.end());
  const auto is_layer = [&](double count) { return count >= least; };
  const size_t bin =
      sign > 0
          ? static_cast<size_t>(std::find_if(counts.begin(), counts.end(), is_layer) - counts.begin())
          : counts.size() - 1 -
                static_cast<size_t>(std::find_if(counts.rbegin(), counts.rend(), is_layer) - counts.rbegin());
  return layer_near(heights_m, lowest + (static_cast<double>(bin) + 0.5) * kBin_m);
}

Levels find_levels(const ColoredCloud& cloud, const Eigen::Quaterniond& R_plan_world) {
  constexpr float kLevel = 0.95F;  // cosine of 18 degrees
  constexpr double kLeastHeight_m = 1.9, kLeastArea = 0.05, kMostAbove = 0.002, kNoise_m = 0.1;
  const Eigen::Vector3f up = (R_plan_world.inverse() * Eigen::Vector3d::UnitZ()).cast<float>();
  std::vector<double> upwards_m, downwards_m;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const float z = cloud.normals[i].dot(up);
    if (z > kLevel) upwards_m.push_back(up.dot(cloud.points[i]));
    if (z < -kLevel) downwards_m.push_back(up.dot(cloud.points[i]));
  }
  const auto floor_m = outermost_layer(upwards_m, 1);
  if (!floor_m) throw InputError("the map shows no floor");
  std::erase_if(downwards_m, [&](double z_m) { return z_m < *floor_m + kLeastHeight_m; });
  Levels levels{*floor_m, {}};
  if (static_cast<double>(downwards_m.size()) < kLeastArea * static_cast<double>(upwards_m.size()))
    return levels;
  const double highest_m = *outermost_layer(downwards_m, -1);
  // The undersides of shelves and lamps are no ceiling: there is more above them.
  const auto above = std::count_if(cloud.points.begin(), cloud.points.end(), [&](const Eigen::Vector3f& p) {
    return up.dot(p) > highest_m + kNoise_m;
  });
  if (static_cast<double>(above) < kMostAbove * static_cast<double>(cloud.size()))
    levels.ceiling_m = highest_m;
  return levels;
}

/// Returns the points of upright surfaces within `range` above the floor.
std::vector<UprightPoint> upright_points(const ColoredCloud& cloud, const Eigen::Quaterniond& R_plan_world,
                                         double floor_m, const HeightRange& range) {
  constexpr double kUpright = 0.2;  // sine of 12 degrees
  std::vector<UprightPoint> points;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p = R_plan_world * cloud.points[i].cast<double>();
    const Eigen::Vector3d normal = R_plan_world * cloud.normals[i].cast<double>();
    if (std::abs(normal.z()) > kUpright || !range.contains(p.z() - floor_m)) continue;
    points.push_back({p.head<2>(), normal.head<2>().normalized(), p.z() - floor_m});
  }
  return points;
}

/// Returns the height of the points without the highest few.
double highest_m(std::span<const UprightPoint> points) {
  constexpr double kHighest = 0.98;
  std::vector<double> heights_m;
  for (const UprightPoint& point : points) heights_m.push_back(point.z_m);
  return quantile(std::move(heights_m), kHighest);
}

PlanGrid grid_around(std::span<const UprightPoint> points) {
  constexpr double kMargin_m = 1, kOutermost = 0.0005;
  constexpr double kLargest_m = 200;
  PlanGrid grid;
  std::vector<double> x, y;
  for (const UprightPoint& point : points) x.push_back(point.p_m.x()), y.push_back(point.p_m.y());
  const Eigen::Vector2d low(quantile(x, kOutermost), quantile(y, kOutermost));
  const Eigen::Vector2d high(quantile(x, 1 - kOutermost), quantile(y, 1 - kOutermost));
  grid.origin_m = low.array() - kMargin_m;
  const Eigen::Vector2d size_m = (high - low).array() + 2 * kMargin_m;
  if (size_m.maxCoeff() > kLargest_m) throw InputError("the map is too large for a floor plan");
  grid.size = {static_cast<int>(std::ceil(size_m.x() / grid.cell_m)),
               static_cast<int>(std::ceil(size_m.y() / grid.cell_m))};
  return grid;
}

PlanRoom room_of(const RoomShape& shape) {
  PlanRoom room;
  room.area_m2 = shape.area_m2();
  const auto add = [&](const RoomOutline& outline) {
    for (size_t i = 0; i < outline.size(); ++i)
      room.walls.push_back(
          {outline[i].from_m, outline[(i + 1) % outline.size()].from_m, outline[i].observed, {}});
  };
  add(shape.outer);
  for (const PlanWall& wall : room.walls) room.perimeter_m += wall.length_m();
  for (const RoomOutline& outline : shape.inner) add(outline);
  return room;
}

/// Returns a mask of the rooms without a margin along their walls.
cv::Mat interior(std::span<const RoomShape> rooms, const PlanGrid& grid) {
  constexpr double kMargin_m = 0.1;
  cv::Mat mask = cv::Mat::zeros(grid.size, CV_8UC1);
  for (const RoomShape& room : rooms) {
    std::vector<std::vector<cv::Point>> polygons;
    const auto add = [&](const RoomOutline& outline) {
      auto& polygon = polygons.emplace_back();
      for (const RoomSide& side : outline) polygon.push_back(grid.cell(side.from_m));
    };
    add(room.outer);
    for (const RoomOutline& outline : room.inner) add(outline);
    cv::fillPoly(mask, polygons, 255);
  }
  const int margin = static_cast<int>(std::lround(kMargin_m / grid.cell_m));
  cv::erode(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {2 * margin + 1, 2 * margin + 1}));
  return mask;
}

/// Returns outlines of what stands in the rooms.
std::vector<PlanPolygon> objects_in(const FloorPlanInput& input, double floor_m, const cv::Mat& interior,
                                    const PlanGrid& grid) {
  constexpr double kLeastHeight_m = 0.03;  // of a column of points
  constexpr double kSmooth_cells = 1.2, kLeastArea_m2 = 0.03;
  const double least_points = std::max(1.0, std::round(kLeastHeight_m / input.voxel_m));
  cv::Mat counts = cv::Mat::zeros(grid.size, CV_8UC1);
  for (const Eigen::Vector3f& point : input.cloud.points) {
    const Eigen::Vector3d p = input.R_file_world * point.cast<double>();
    const cv::Point cell = grid.cell(p.head<2>());
    if (!kObjects.contains(p.z() - floor_m) || !grid.contains(cell)) continue;
    auto& count = counts.at<uint8_t>(cell);
    count = static_cast<uint8_t>(std::min(count + 1, 255));
  }
  cv::Mat taken = (counts >= least_points) & interior;
  const cv::Mat disk = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  cv::morphologyEx(taken, taken, cv::MORPH_CLOSE, disk);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(taken, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::vector<PlanPolygon> objects;
  for (const auto& contour : contours) {
    // The contour runs through the middles of the outermost cells.
    const double cells = cv::contourArea(contour) + cv::arcLength(contour, true) / 2 + 1;
    if (cells * grid.cell_m * grid.cell_m < kLeastArea_m2) continue;
    std::vector<cv::Point> corners;
    cv::approxPolyDP(contour, corners, kSmooth_cells, true);
    PlanPolygon polygon;
    for (const cv::Point& corner : corners) polygon.push_back(grid.middle_m(corner));
    objects.push_back(std::move(polygon));
  }
  return objects;
}

}  // namespace

FloorPlan make_floor_plan(const FloorPlanInput& input, const Progress& progress) {
  constexpr double kHighest_m = 2.6;  // of walls, if no ceiling was seen
  if (input.cloud.normals.size() != input.cloud.size()) throw InputError("the cloud has no normals");
  const Levels levels = find_levels(input.cloud, input.R_file_world);
  std::optional<double> height_m;
  if (levels.ceiling_m) height_m = *levels.ceiling_m - levels.floor_m;
  const double high_m = height_m ? *height_m - kBelowCeiling_m : kHighest_m;
  const auto points =
      upright_points(input.cloud, input.R_file_world, levels.floor_m, {kLowestOfWalls_m, high_m});
  if (points.empty()) throw InputError("the map shows no walls");
  const PlanGrid grid = grid_around(points);
  const SE3 T_plan_world{input.R_file_world, {0, 0, -levels.floor_m}};
  const std::array<HeightRange, 3> ranges{{{kLowestOfWalls_m, high_m}, kLowSight, kHighSight}};
  const auto free_space = observed_free_space(
      {input.images, input.views, input.camera, T_plan_world, input.limits}, grid, ranges, progress);
  const auto walls =
      without_furniture(find_wall_lines(points, input.voxel_m * input.voxel_m), highest_m(points), height_m);
  const auto shapes = find_rooms(walls, free_space[0], grid);
  if (shapes.empty()) throw InputError("the map shows no room: no space that walls enclose");
  FloorPlan plan;
  plan.floor_z_m = levels.floor_m;
  plan.ceiling_m = height_m;
  for (const RoomShape& shape : shapes) plan.rooms.push_back(room_of(shape));
  find_openings(plan.rooms, {free_space[1], free_space[2], grid});
  plan.objects = objects_in(input, levels.floor_m, interior(shapes, grid), grid);
  return plan;
}

const char* to_string(OpeningKind kind) {
  return kind == OpeningKind::kDoorway ? "doorway" : "hole";
}

}  // namespace kinloop
