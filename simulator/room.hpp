#pragma once
// In: a camera path and a seed. Out: a furnished room around the path that the camera can move through.

#include <memory>

#include "kinloop/geometry/trajectory.hpp"
#include "simulator/scene.hpp"

namespace kinloop::sim {

/// A room and its pose in the path's world. Room frame: z up, origin in the middle of the floor.
struct Room {
  std::unique_ptr<const Scene> scene;
  Eigen::Vector3d size_m;
  SE3 T_world_room;
};

/// Builds the room of `seed` around a path: walls some distance outside the path's bounding box, furniture
/// along the walls and where the camera looks, nothing within `kPathClearance_m` (room_layout.hpp) of the
/// path. The floor is placed so that the camera is mostly at the height of a standing person's hands. Throws
/// InputError for a path too large for a room.
Room build_room(const Trajectory& path, uint64_t seed, int threads);

}  // namespace kinloop::sim
