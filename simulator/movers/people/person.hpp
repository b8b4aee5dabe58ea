#pragma once
// In: a figure, its clothes and its walk. Out: the solids of the person at a time.

#include "simulator/movers/people/clothes.hpp"
#include "simulator/movers/people/figure.hpp"
#include "simulator/room/furniture.hpp"

namespace kinloop::sim {

/// Somebody who walks about in a room.
struct Person {
  Figure figure;
  Outfit outfit;
  Walk walk;
};

/// Returns the joints of a person at a time since the beginning of the walk.
Joints joints_at(const Person& person, double time_s);

/// Returns the solids of a person at a time since the beginning of the walk. Neighbouring solids overlap at
/// the joint between them.
Parts person_at(const Person& person, double time_s);

}  // namespace kinloop::sim
