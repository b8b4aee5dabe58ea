#include "kinloop/mapping/complete_tracks.hpp"

#include <algorithm>

#include "kinloop/mapping/landmark_creation.hpp"

namespace kinloop {
namespace {

bool sees(const Landmark& landmark, KeyframeId keyframe) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [&](const Observation& seen) { return seen.keyframe == keyframe; });
}

/// Whether some keyframe observes both, which proves that they are distinct.
bool observed_together(const Landmark& a, const Landmark& b) {
  return std::any_of(a.observations.begin(), a.observations.end(),
                     [&](const Observation& seen) { return sees(b, seen.keyframe); });
}

}  // namespace

void complete_tracks(Map& map, const PinholeCamera& camera, const LocalMapOptions& local_map,
                     const MappingOptions& options) {
  for (uint32_t i = 0; i < map.keyframes().size(); ++i) {
    const KeyframeId id{i};
    for (const auto& [landmark, feature] :
         find_unobserved_landmarks(map, id, make_local_map(map, id, local_map), camera, options)) {
      if (!map.contains(landmark)) continue;  // already merged
      const LandmarkId existing = map.keyframe(id).landmark_of[feature];
      if (!existing.valid()) {
        map.add_observation(landmark, {id, feature});
      } else if (existing != landmark && !observed_together(map.landmark(landmark), map.landmark(existing))) {
        const bool more =
            map.landmark(landmark).observations.size() > map.landmark(existing).observations.size();
        map.merge(more ? existing : landmark, more ? landmark : existing);
      }
    }
  }
}

}  // namespace kinloop
