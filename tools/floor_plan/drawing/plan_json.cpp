#include <nlohmann/json.hpp>

#include "kinloop/core/text/rounded_number.hpp"
#include "tools/floor_plan/drawing/draw_plan.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

json point(const Eigen::Vector2d& p) {
  return {rounded_number(p.x()), rounded_number(p.y())};
}

json wall_json(const PlanWall& wall) {
  json openings = json::array();
  for (const PlanOpening& opening : wall.openings) {
    openings.push_back({{"kind", to_string(opening.kind)},
                        {"begin_m", rounded_number(opening.begin_m)},
                        {"end_m", rounded_number(opening.end_m)},
                        {"width_m", rounded_number(opening.end_m - opening.begin_m)}});
  }
  return {{"from", point(wall.from_m)},
          {"to", point(wall.to_m)},
          {"length_m", rounded_number(wall.length_m())},
          {"observed", rounded_number(wall.observed)},
          {"openings", openings}};
}

}  // namespace

json to_json(const FloorPlan& plan) {
  json rooms = json::array(), objects = json::array();
  for (const PlanRoom& room : plan.rooms) {
    json walls = json::array();
    for (const PlanWall& wall : room.walls) walls.push_back(wall_json(wall));
    rooms.push_back({{"area_m2", rounded_number(room.area_m2)},
                     {"perimeter_m", rounded_number(room.perimeter_m)},
                     {"walls", walls}});
  }
  for (const PlanPolygon& polygon : plan.objects) {
    json corners = json::array();
    for (const Eigen::Vector2d& corner : polygon) corners.push_back(point(corner));
    objects.push_back(corners);
  }
  return {{"floor_z_m", rounded_number(plan.floor_z_m)},
          {"ceiling_height_m", plan.ceiling_m ? json(rounded_number(*plan.ceiling_m)) : json()},
          {"rooms", rooms},
          {"objects", objects}};
}

}  // namespace kinloop
