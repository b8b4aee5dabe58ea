#pragma once
// Decides whether the map already ties two places together, so that a loop between them would add nothing.

#include <vector>

#include "kinloop/map/map.hpp"

namespace kinloop {

/// Returns a keyframe and its covisible keyframes in ascending order: the keyframes that show its place.
std::vector<KeyframeId> covisible_group(const Map& map, KeyframeId keyframe);

/// The place shown by a group of keyframes, and the landmarks they observe.
class KnownPlace {
 public:
  /// `keyframes` are in ascending order. `map` must outlive this object and not change.
  KnownPlace(const Map& map, std::vector<KeyframeId> keyframes);

  /// Returns whether the keyframes of `group` (in ascending order) are tied to this place by at least
  /// `min_landmarks`: landmarks observed by both groups, and inliers of loop edges between them, whose
  /// landmarks may not be merged yet.
  [[nodiscard]] bool is_tied_to(const std::vector<KeyframeId>& group, int min_landmarks) const;

 private:
  [[nodiscard]] int count_loop_inliers(const std::vector<KeyframeId>& group) const;

  const Map& map_;
  std::vector<KeyframeId> keyframes_;
  std::vector<bool> observed_;  // by landmark id
};

}  // namespace kinloop
