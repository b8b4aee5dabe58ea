#pragma once
// Judges the joins of two visits again as their views become more. Floors of a building are furnished alike:
// the first views may agree, and the pictures on the next wall do not.

#include <map>
#include <utility>
#include <vector>

#include "kinloop/loop/compare_visits.hpp"

namespace kinloop {

/// Compares visits that accepted loop closures have joined, keyframe by keyframe.
class JoinCheck {
 public:
  /// Compares the keyframes added since the last call with the views of the visits that theirs is joined to.
  /// Returns the loop closures between visits that turn out to be different rooms, by at least `min_views`
  /// pairs of views.
  std::vector<LoopEnds> find_refuted(const Map& map, const Sensor& sensor, int min_views);

 private:
  struct Join {
    std::vector<LoopEnds> loops;
    RoomComparison comparison;
    uint32_t next_keyframe = 0;  ///< the first not yet compared
  };
  using Visits = std::pair<uint32_t, uint32_t>;  // the earlier first

  void find_joins(const Map& map);
  static void compare(const Visits& visits, Join& join, const Map& map, const Sensor& sensor);

  std::map<Visits, Join> joins_;
};

}  // namespace kinloop
