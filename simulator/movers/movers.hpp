#pragma once
// In: people, a door and chairs. Out: their solids at any time.

#include <cstdint>
#include <optional>
#include <vector>

#include "simulator/movers/door.hpp"
#include "simulator/movers/people/person.hpp"
#include "simulator/movers/pushed_chair.hpp"

namespace kinloop::sim {

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

}  // namespace kinloop::sim
