#pragma once
// In: where a room has its door. Out: a doorway in the wall, and a door that swings in it.

#include <vector>

#include "simulator/movers/people/walk_plan.hpp"
#include "simulator/room/furniture.hpp"
#include "simulator/room/room_layout.hpp"

namespace kinloop::sim {

/// A turn of the door from one angle to another.
struct DoorSwing {
  double begin_s = 0, seconds = 1;
  float from_rad = 0, to_rad = 0;
};

/// A door that turns about a vertical hinge, 0 = closed.
struct SwingingDoor {
  Parts closed;           ///< room frame
  Eigen::Vector3f hinge;  ///< a point of its axis
  std::vector<DoorSwing> swings;
};

/// Returns the angle at a time since the beginning, rad.
float angle_at(const SwingingDoor& door, double time_s);

/// Returns whether the door is turning.
bool is_turning(const SwingingDoor& door, double time_s);

/// Returns the solids of the door at a time since the beginning.
Parts door_at(const SwingingDoor& door, double time_s);

/// Takes the door out of a room's solids, cuts an opening into the wall behind it and builds a short corridor
/// there. The door opens into the corridor several times, mostly when the camera looks at it.
SwingingDoor open_doorway(Parts& room, const DoorPlace& place, FurnitureBuilder& builder,
                          const FloorTrack& camera);

}  // namespace kinloop::sim
