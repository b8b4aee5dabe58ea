#include <algorithm>
#include <vector>

#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/map/observers.hpp"

namespace kinloop {
namespace {

/// The keyframes that may see what this one sees, at most a few of them, evenly over time.
std::vector<KeyframeId> views_of_place(const Map& map, const Keyframe& keyframe) {
  constexpr double kMaxDistance_m = 2, kMinCosine = 0.5;  // of the angle between the optical axes
  constexpr size_t kMaxCount = 32;
  const Eigen::Vector3d axis_world = keyframe.T_world_camera.rotation * Eigen::Vector3d::UnitZ();
  std::vector<KeyframeId> all;
  for (const Keyframe& other : map.keyframes()) {
    if (!other.surfaces || other.withdrawn || other.component != keyframe.component) continue;
    const SE3& T_world_other = other.T_world_camera;
    const double away_m = (T_world_other.translation - keyframe.T_world_camera.translation).norm();
    if (away_m > kMaxDistance_m) continue;
    const double cosine = axis_world.dot(T_world_other.rotation * Eigen::Vector3d::UnitZ());
    if (cosine > kMinCosine) all.push_back(other.id);
  }
  std::vector<KeyframeId> views;
  const size_t count = std::min(all.size(), kMaxCount);
  for (size_t i = 0; i < count; ++i) views.push_back(all[i * all.size() / count]);
  return views;
}

/// Whether the coarse surfaces can tell that there is nothing at the landmark: its depth was measured, and
/// its anchor does not see through it itself, as through a cable.
bool is_decidable(const Landmark& landmark, const Map& map) {
  const Keyframe& anchor = map.keyframe(landmark.anchor);
  return has_measured_depth(landmark, map) &&
         !(anchor.surfaces &&
           state_in_view(landmark.p_anchor, *anchor.surfaces) == PointState::kContradicted);
}

/// Whether the views say that there is nothing at the landmark.
bool has_moved(const Landmark& landmark, const std::vector<KeyframeId>& views, const Map& map) {
  constexpr int kMinSeenThrough = 2;
  const Eigen::Vector3d p_world = map.p_world(landmark.id);
  int seen_through = 0, found = 0;
  for (const KeyframeId id : views) {
    if (observes(id, landmark)) continue;
    const Keyframe& view = map.keyframe(id);
    const PointState state = state_in_view(view.T_world_camera.inverse() * p_world, *view.surfaces);
    seen_through += state == PointState::kContradicted ? 1 : 0;
    found += state == PointState::kConsistent ? 1 : 0;
  }
  return seen_through >= kMinSeenThrough && seen_through > found;
}

}  // namespace

size_t erase_moved_landmarks(Map& map) {
  std::vector<std::vector<KeyframeId>> views;  // by keyframe
  for (const Keyframe& keyframe : map.keyframes()) views.push_back(views_of_place(map, keyframe));
  std::vector<LandmarkId> moved;
  for (const LandmarkId id : map.landmark_ids()) {
    const Landmark& landmark = map.landmark(id);
    if (is_decidable(landmark, map) && has_moved(landmark, views[landmark.anchor.value], map))
      moved.push_back(id);
  }
  for (const LandmarkId id : moved) map.erase(id);
  return moved.size();
}

}  // namespace kinloop
