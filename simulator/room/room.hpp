#pragma once
// In: a camera path and a seed, and what shall move. Out: a furnished room around the path that the camera
// can move through.

#include <memory>

#include "kinloop/geometry/trajectory.hpp"
#include "simulator/movers/mover_options.hpp"
#include "simulator/render/scene.hpp"

namespace kinloop::sim {

/// A room and its pose in the path's world. Room frame: z up, origin in the middle of the floor.
struct Room {
  std::unique_ptr<const Scene> scene;
  Eigen::Vector3d size_m;
  SE3 T_world_room;
};

/// What to build.
struct RoomRequest {
  uint64_t seed = 1;
  bool spacious = false;  ///< walls farther away and little furniture in the middle; so with people, chairs
  MoverOptions movers = {};
  bool corridor = false;  ///< instead of a room: narrow, with the same doors again and again
  uint64_t floor = 0;     ///< see RoomLayout
};

/// Returns a path of the world in the frame of a room.
Trajectory in_room_frame(Trajectory path, const SE3& T_room_world);

/// Builds the room of a seed around a path: walls some distance outside the path's bounding box, furniture
/// along the walls and where the camera looks, nothing within `kPathClearance_m` (room_layout.hpp) of the
/// path. The floor is placed so that the camera is mostly at the height of a standing person's hands. Throws
/// InputError for a path too large for a room.
Room build_room(const Trajectory& path, const RoomRequest& request, int threads);

}  // namespace kinloop::sim
