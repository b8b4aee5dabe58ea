#pragma once
// Loop detection: finds older keyframes that look like the same place as a new keyframe, using the place
// index. A loop between places that already share many landmarks would add little.

#include <vector>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

/// Returns a keyframe and its covisible keyframes in ascending order: the keyframes that show its place.
std::vector<KeyframeId> covisible_group(const Map& map, KeyframeId keyframe);

/// The place shown by a group of keyframes, and the landmarks they observe.
class KnownPlace {
 public:
  /// `keyframes` are in ascending order. `map` must outlive this object and not change.
  KnownPlace(const Map& map, std::vector<KeyframeId> keyframes);

  /// Returns whether the keyframes of `group` (in ascending order) share at least `min_landmarks` with this
  /// place: landmarks observed by both groups, and inliers of loop closures between them, whose landmarks may
  /// not be merged yet.
  [[nodiscard]] bool shares_landmarks_with(const std::vector<KeyframeId>& group, int min_landmarks) const;

 private:
  [[nodiscard]] int count_loop_inliers(const std::vector<KeyframeId>& group) const;

  const Map& map_;
  std::vector<KeyframeId> keyframes_;
  std::vector<bool> observed_;  // by landmark id
};

/// Returns loop candidates for `keyframe`, most similar first: keyframes that are at least
/// `min_gap_keyframes` older or in another component, are not covisible with it, and are as similar to it as
/// its covisible keyframes (relative score, Galvez-Lopez and Tardos 2012; Mur-Artal and Tardos 2014). Places
/// that share as many landmarks with that of `keyframe` as the keyframe observes are left out. Whether
/// keyframes agree is decided on measured poses, see hypotheses.hpp.
std::vector<KeyframeId> find_loop_candidates(const Map& map, const PlaceIndex& index, KeyframeId keyframe,
                                             const LoopOptions& options);

}  // namespace kinloop
