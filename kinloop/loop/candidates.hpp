#pragma once
// In: a keyframe and the place index. Out: keyframes that look like the same place seen long before.

#include <vector>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

/// A place some keyframes in a row have pointed to: those that show it, and how many keyframes in a row.
struct CandidateGroup {
  std::vector<KeyframeId> keyframes;  ///< in ascending order
  int consistency = 0;
};

/// What the detector remembers from one keyframe to the next.
using CandidateHistory = std::vector<CandidateGroup>;

struct LoopDetection {
  std::vector<KeyframeId> keyframes;  ///< to be verified, most alike first
  CandidateHistory history;           ///< for the next keyframe
};

/// Keyframes at least `min_gap_keyframes` older than `keyframe` or of another component, and not covisible
/// with it, as alike as its own neighbours are (relative score), to whose surroundings `consistent_keyframes`
/// keyframes in a row have pointed (Galvez-Lopez and Tardos 2012; Mur-Artal and Tardos 2014).
LoopDetection find_loop_candidates(const Map& map, const PlaceIndex& index, KeyframeId keyframe,
                                   const CandidateHistory& history, const LoopOptions& options);

}  // namespace kinloop
