#pragma once
// In: the cloud and the posed depth images of a map. Out: its floor plan: rooms, walls, doors and what stands
// about. The plan has the axes of the file frame (z up) and the units metres.

#include <optional>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"
#include "tools/floor_plan/rooms.hpp"

namespace kinloop {

enum class OpeningKind {
  kDoorway,  ///< the space beyond was seen down to near the floor
  kHole,     ///< seen through above a sill, or above what stands before it
};

/// Returns "doorway" or "hole".
const char* to_string(OpeningKind kind);

/// A part of a wall.
struct PlanOpening {
  OpeningKind kind = OpeningKind::kDoorway;
  double begin_m = 0, end_m = 0;  ///< distance from the beginning of the wall
};

struct PlanWall {
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero(), to_m = Eigen::Vector2d::Zero();  ///< the room to the left
  double observed = 0;  ///< share of its length at which surface was observed, 0 to 1
  std::vector<PlanOpening> openings;

  [[nodiscard]] double length_m() const { return (to_m - from_m).norm(); }
};

struct PlanRoom {
  std::vector<PlanWall> walls;  ///< the outline, counterclockwise, then clockwise what stands in the room
  double area_m2 = 0;
  double perimeter_m = 0;  ///< of the outline
};

/// A closed polygon.
using PlanPolygon = std::vector<Eigen::Vector2d>;

struct FloorPlan {
  double floor_z_m = 0;              ///< in the file frame
  std::optional<double> ceiling_m;   ///< its height above the floor, if it was seen
  std::vector<PlanRoom> rooms;       ///< the largest first
  std::vector<PlanPolygon> objects;  ///< outlines of what stands in the rooms, 0.1 to 1.8 m above the floor
};

struct FloorPlanInput {
  const ColoredCloud& cloud;  ///< world frame, with normals
  const ImageStore& images;
  std::span<const PosedImage> views;
  const PinholeCamera& camera;
  Eigen::Quaterniond R_file_world;  ///< to the frame of the plan, z up
  double voxel_m = 0.01;            ///< of the cloud
  DepthLimits limits = {};
};

/// Draws the plan of a map. Throws InputError if the cloud has no floor or no walls.
FloorPlan make_floor_plan(const FloorPlanInput& input, const Progress& progress = {});

}  // namespace kinloop
