#pragma once
// Which keyframes have seen a landmark, and what of it.

#include <algorithm>

#include "kinloop/map/map.hpp"

namespace kinloop {

/// Returns whether a keyframe observes a landmark.
inline bool observes(KeyframeId keyframe, const Landmark& landmark) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [&](const Observation& seen) { return seen.keyframe == keyframe; });
}

/// Returns whether a keyframe has measured the landmark's depth; otherwise it was triangulated.
inline bool has_measured_depth(const Landmark& landmark, const Map& map) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [&](const Observation& seen) {
                       return map.keyframe(seen.keyframe).features->depths_m[seen.feature] > 0;
                     });
}

}  // namespace kinloop
