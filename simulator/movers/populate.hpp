#pragma once
// In: a furnished room and a camera path in it. Out: the people, door and chairs that move there.

#include "simulator/movers/mover_options.hpp"
#include "simulator/movers/movers.hpp"
#include "simulator/movers/people/clothes.hpp"

namespace kinloop::sim {

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
