#pragma once
// In: the free floor of a room. Out: chairs that are pushed to another place at some time, and stay there.

#include "simulator/movers/people/walk_plan.hpp"
#include "simulator/room/furniture.hpp"

namespace kinloop::sim {

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

}  // namespace kinloop::sim
