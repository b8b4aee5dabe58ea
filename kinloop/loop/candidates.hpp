#pragma once
// Loop detection: finds older keyframes that look like the same place as a new keyframe, using the place
// index.

#include <vector>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

/// A place to which consecutive keyframes have pointed: the keyframes that show it, and the number of
/// consecutive keyframes.
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

/// Returns keyframes at least `min_gap_keyframes` older than `keyframe` or of another component, not
/// covisible with it, as similar to it as its own neighbours are (relative score), to whose surroundings
/// `consistent_keyframes` consecutive keyframes have pointed (Galvez-Lopez and Tardos 2012; Mur-Artal and
/// Tardos 2014).
LoopDetection find_loop_candidates(const Map& map, const PlaceIndex& index, KeyframeId keyframe,
                                   const CandidateHistory& history, const LoopOptions& options);

}  // namespace kinloop
