#pragma once
// In: a furnished room and a camera path in it. Out: the people, door and chairs that move there, and their
// solids at any time.

#include <cstdint>
#include <optional>
#include <vector>

#include "simulator/movers/mover_options.hpp"
#include "simulator/movers/people/clothes.hpp"
#include "simulator/movers/people/person.hpp"
#include "simulator/movers/people/walk_plan.hpp"
#include "simulator/room/furniture.hpp"
#include "simulator/room/room_layout.hpp"

namespace kinloop::sim {

// A doorway in the wall, and a door that swings in it.

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

// Chairs that are pushed to another place at some time, and stay there.

/// Where a chair stands.
struct ChairPlace {
  Eigen::Vector2f position;  ///< of its middle, room frame, m
  float yaw_rad = 0;
};

/// A chair that is pushed once.
struct PushedChair {
  Parts parts;  ///< with the middle of the seat over the origin
  ChairPlace before, after;
  double begin_s = 0, seconds = 1;  ///< of the push
};

/// Returns where a chair stands at a time since the beginning.
ChairPlace place_at(const PushedChair& chair, double time_s);

/// Returns whether the chair is being pushed.
bool is_pushed(const PushedChair& chair, double time_s);

/// Returns the solids of a chair at a time since the beginning.
Parts chair_at(const PushedChair& chair, double time_s);

/// Returns a chair that is pushed 0.4 to 1.3 m between a fifth and three fifths of the time, from and to
/// where the camera looks, more often than not while it looks, and blocks both places. `floor` is that for
/// the radius of a chair. Throws InputError if there is no room for it.
PushedChair place_chair(FreeFloor& floor, const FloorTrack& camera, FurnitureBuilder& builder);

/// Radius of the floor that a chair takes, m.
constexpr float kChairRadius_m = 0.34F;

/// The solids of all movers at one time.
struct MoverPoses {
  Parts parts;
  size_t in_motion = 0;  ///< that many of the first parts are moving; the others are at rest
};

/// What moves in a room. Poses are functions of time alone.
struct Movers {
  int64_t begin_ns = 0;  ///< the stamp at which the times of all movers are 0
  std::vector<Person> people;
  std::optional<SwingingDoor> door;
  std::vector<PushedChair> chairs;

  [[nodiscard]] bool empty() const { return people.empty() && !door && chairs.empty(); }
  [[nodiscard]] MoverPoses at(int64_t stamp_ns) const;
};

/// A room that movers are added to.
struct MoverSite {
  Eigen::Vector3f size_m;
  const CameraPath* camera;  ///< room frame
  DoorPlace door;
  const Palette* palette;
};

/// Returns the movers of `seed`. A door is taken out of `room`, and a corridor is added behind it. Clothes
/// come from `wardrobe`.
Movers populate(Parts& room, const MoverSite& site, const MoverOptions& options, Wardrobe& wardrobe,
                uint64_t seed);

}  // namespace kinloop::sim
