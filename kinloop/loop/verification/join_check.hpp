#pragma once
// Judges the joins of two visits again as their views become more. Floors of a building are furnished alike:
// the first views hardly show a picture, and those on the next wall are others.

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "kinloop/loop/verification/compare_visits.hpp"

namespace kinloop {

/// Two visits, the earlier first.
using VisitPair = std::pair<uint32_t, uint32_t>;

/// What keyframes of two joined visits say of each other, see `compare_aligned`.
struct ViewPairResult {
  VisitPair visits;
  std::optional<ViewComparison> views;
};

/// Compares keyframes that show the same if the join of their visits is true, the earlier visit first.
ViewPairResult compare_joined(const OverlappingViews& views, const Sensor& sensor);

/// Collects what the keyframes of visits that loop closures have joined say of each other.
class JoinCheck {
 public:
  /// Returns whether `take_views` has new keyframes to look at.
  [[nodiscard]] bool has_views(const Map& map) const;

  /// Returns each keyframe of the later visits once, with the nearest view of each visit that its own is
  /// joined to. Keyframes more than 4 m from the loops say nothing, for drift, nor those of loaded maps, of
  /// which it is not known what moved.
  std::vector<OverlappingViews> take_views(const Map& map);

  /// Adds what they say.
  void add(const std::vector<ViewPairResult>& results);

  /// Returns the loop closures between visits that are different rooms by at least `min_views` pairs of
  /// views, and forgets what was said of them.
  std::vector<LoopEnds> take_contradicted(const Map& map, int min_views);

 private:
  struct Evidence {
    uint32_t next_keyframe = 0;  ///< the first not looked at
    AppearanceTally appearance;
  };

  std::map<VisitPair, Evidence> joins_;
};

}  // namespace kinloop
