#include "kinloop/mapping/complete_tracks.hpp"

#include <algorithm>

#include "kinloop/mapping/grow.hpp"

namespace kinloop {
namespace {

bool sees(const Landmark& landmark, KeyframeId keyframe) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [&](const Observation& seen) { return seen.keyframe == keyframe; });
}

/// Whether some keyframe sees both, and so sees them to be two.
bool told_apart(const Landmark& a, const Landmark& b) {
  return std::any_of(a.observations.begin(), a.observations.end(),
                     [&](const Observation& seen) { return sees(b, seen.keyframe); });
}

}  // namespace

void complete_tracks(Map& map, const PinholeCamera& camera, const LocalViewOptions& view,
                     const MappingOptions& options) {
  for (uint32_t i = 0; i < map.keyframes().size(); ++i) {
    const KeyframeId id{i};
    for (const auto& [landmark, feature] :
         find_unseen_landmarks(map, id, make_local_view(map, id, view), camera, options)) {
      if (!map.contains(landmark)) continue;  // merged a moment ago
      const LandmarkId there = map.keyframe(id).landmark_of[feature];
      if (!there.valid()) {
        map.observe(landmark, {id, feature});
      } else if (there != landmark && !told_apart(map.landmark(landmark), map.landmark(there))) {
        const bool more =
            map.landmark(landmark).observations.size() > map.landmark(there).observations.size();
        map.merge(more ? there : landmark, more ? landmark : there);
      }
    }
  }
}

}  // namespace kinloop
