#pragma once
// Loop detection: finds older keyframes that look like the same place as a new keyframe, using the place
// index.

#include <vector>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

/// A place that consecutive keyframes have matched: the keyframes that show it, and the number of consecutive
/// matches.
struct CandidateGroup {
  std::vector<KeyframeId> keyframes;  ///< in ascending order
  int consistency = 0;
};

/// The detector's state between keyframes.
using CandidateHistory = std::vector<CandidateGroup>;

struct LoopDetection {
  std::vector<KeyframeId> keyframes;  ///< to be verified, most similar first
  CandidateHistory history;           ///< for the next keyframe
};

/// Returns loop candidates for `keyframe`: keyframes that are at least `min_gap_keyframes` older or in
/// another component, are not covisible with it, and are as similar to it as its covisible keyframes
/// (relative score). `consistent_keyframes` consecutive keyframes must have matched their surroundings
/// (Galvez-Lopez and Tardos 2012; Mur-Artal and Tardos 2014). Places that the map already ties to that of
/// `keyframe` by more landmarks than `keyframe` observes are left out: a loop would add little.
LoopDetection find_loop_candidates(const Map& map, const PlaceIndex& index, KeyframeId keyframe,
                                   const CandidateHistory& history, const LoopOptions& options);

}  // namespace kinloop
