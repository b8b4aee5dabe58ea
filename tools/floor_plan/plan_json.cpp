#include <cmath>

#include <nlohmann/json.hpp>

#include "tools/floor_plan/draw_plan.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

/// Rounds to tenths of millimetres.
double rounded(double value) {
  constexpr double kUnits = 1e4;
  return std::round(value * kUnits) / kUnits;
}

json point(const Eigen::Vector2d& p) {
  return {rounded(p.x()), rounded(p.y())};
}

json wall_json(const PlanWall& wall) {
  json openings = json::array();
  for (const PlanOpening& opening : wall.openings) {
    openings.push_back({{"kind", to_string(opening.kind)},
                        {"begin_m", rounded(opening.begin_m)},
                        {"end_m", rounded(opening.end_m)},
                        {"width_m", rounded(opening.end_m - opening.begin_m)}});
  }
  return {{"from", point(wall.from_m)},
          {"to", point(wall.to_m)},
          {"length_m", rounded(wall.length_m())},
          {"observed", rounded(wall.observed)},
          {"openings", openings}};
}

}  // namespace

json to_json(const FloorPlan& plan) {
  json rooms = json::array(), objects = json::array();
  for (const PlanRoom& room : plan.rooms) {
    json walls = json::array();
    for (const PlanWall& wall : room.walls) walls.push_back(wall_json(wall));
    rooms.push_back(
        {{"area_m2", rounded(room.area_m2)}, {"perimeter_m", rounded(room.perimeter_m)}, {"walls", walls}});
  }
  for (const PlanPolygon& polygon : plan.objects) {
    json corners = json::array();
    for (const Eigen::Vector2d& corner : polygon) corners.push_back(point(corner));
    objects.push_back(corners);
  }
  return {{"floor_z_m", rounded(plan.floor_z_m)},
          {"ceiling_height_m", plan.ceiling_m ? json(rounded(*plan.ceiling_m)) : json()},
          {"rooms", rooms},
          {"objects", objects}};
}

}  // namespace kinloop
