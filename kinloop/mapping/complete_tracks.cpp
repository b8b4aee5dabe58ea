
#include <algorithm>
#include <utility>
#include <vector>

#include "kinloop/map/observers.hpp"
#include "kinloop/map/view_difference.hpp"
#include "kinloop/mapping/landmark_creation.hpp"

namespace kinloop {
namespace {

/// Whether some keyframe observes both, which proves that they are distinct.
bool observed_together(const Landmark& a, const Landmark& b) {
  return std::any_of(a.observations.begin(), a.observations.end(),
                     [&](const Observation& seen) { return observes(seen.keyframe, b); });
}

/// The keyframes with the views most similar to this one's that share hardly any landmark with it: a camera
/// that comes back is not always recognized.
std::vector<KeyframeId> unlinked_views(const Map& map, const Keyframe& keyframe) {
  constexpr size_t kMaxCount = 5;
  std::vector<bool> is_linked(map.keyframes().size(), false);
  is_linked[keyframe.id.value] = true;
  for (const auto& [id, shared] : map.covisible_keyframes(keyframe.id, kMinCovisibleLandmarks))
    is_linked[id.value] = true;
  std::vector<std::pair<double, KeyframeId>> similar;
  for (const Keyframe& other : map.keyframes()) {
    if (is_linked[other.id.value] || other.component != keyframe.component || other.withdrawn) continue;
    const auto difference = view_difference(other.T_world_camera, keyframe.T_world_camera);
    if (difference) similar.emplace_back(*difference, other.id);
  }
  const size_t count = std::min(similar.size(), kMaxCount);
  std::partial_sort(similar.begin(), similar.begin() + static_cast<std::ptrdiff_t>(count), similar.end());
  std::vector<KeyframeId> views;
  for (size_t i = 0; i < count; ++i) views.push_back(similar[i].second);
  return views;
}

}  // namespace

void complete_tracks(Map& map, const PinholeCamera& camera, const LocalMapOptions& local_map,
                     const MappingOptions& options) {
  for (uint32_t i = 0; i < map.keyframes().size(); ++i) {
    const KeyframeId id{i};
    const auto around = make_local_map(map, id, local_map, unlinked_views(map, map.keyframe(id)));
    for (const auto& [landmark, feature] : find_unobserved_landmarks(map, id, around, camera, options)) {
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
