#pragma once
// What moves in a simulated room besides the camera.

#include "kinloop/core/options.hpp"

namespace kinloop {

/// What moves in a simulated room. All of it follows from the seed.
struct MoverOptions {
  int people = 0;
  bool door = false;
  int chairs = 0;

  /// Returns whether anything moves.
  [[nodiscard]] bool any() const { return people > 0 || door || chairs > 0; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("people", self.people, "people who walk about, stop and turn", Range{0, 4});
    visit("door", self.door, "the door of the room opens and closes");
    visit("chairs", self.chairs, "additional chairs, each of which is pushed once and stays there",
          Range{0, 4});
  }
};

}  // namespace kinloop
