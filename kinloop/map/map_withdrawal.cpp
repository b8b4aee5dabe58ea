// How a map takes back loop closures that were false: the landmarks that they merged are again what they
// were, and the components that they joined are split.

#include <algorithm>
#include <set>

#include "kinloop/core/disjoint_sets.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {
namespace {

/// The number of keyframes after which a track of a landmark is said to be interrupted.
constexpr uint32_t kInterruption = 5;

}  // namespace

std::vector<SE3> Map::withdraw_loops(std::span<const LoopEnds> loops, LoopReason reason) {
  std::vector<LoopEnds> within_visits;
  bool between_visits = false;
  for (const LoopEnds& ends : loops) {
    const auto found = std::find_if(loop_closures_.begin(), loop_closures_.end(),
                                    [&](const LoopClosure& l) { return l.ends() == ends; });
    require(found != loop_closures_.end(), "withdraw_loops: no such loop closure");
    LoopClosure loop = *found;
    loop_closures_.erase(found);
    const auto merged = merged_by_loop_.extract(ends);
    if (!merged.empty())
      std::for_each(merged.mapped().rbegin(), merged.mapped().rend(),
                    [this](const MergedLandmark& landmark) { undo_merge(landmark); });
    // What never bent the map was a candidate only.
    loop.stage = loop.corrected ? LoopStage::kWithdrawn : LoopStage::kRejected;
    loop.reason = reason;
    record_loop(loop);
    if (keyframe(ends.a).visit == keyframe(ends.b).visit) {
      within_visits.push_back(ends);
    } else {
      between_visits = true;
    }
  }
  for (const LoopEnds& ends : within_visits) split_tracks(ends);
  if (!between_visits) return {};
  const uint32_t components = component_count_;
  std::vector<SE3> T_world_keyframe_before = keyframe_poses();
  split_components();
  if (component_count_ == components) return {};
  return T_world_keyframe_before;
}

/// Makes a landmark again what it was before a loop closure merged it into another. What later keyframes have
/// observed is what the camera saw at the newer end of the loop, of which it is.
void Map::undo_merge(const MergedLandmark& merged) {
  const LandmarkId into = resolve_merged(merged.into);
  if (contains(merged.from.id) || !contains(into)) return;
  const auto& before = merged.from.observations;
  std::vector<Observation> own;
  for (const Observation& seen : landmark(into).observations) {
    if (seen.keyframe > merged.newest || std::find(before.begin(), before.end(), seen) != before.end())
      own.push_back(seen);
  }
  merged_into_.erase(merged.from.id);
  if (own.empty()) return;
  for (const Observation& seen : own) remove_observation(into, seen);
  const Eigen::Vector3d p_world = keyframe(merged.from.anchor).T_world_camera * merged.from.p_anchor;
  const auto by_anchor = std::find_if(
      own.begin(), own.end(), [&](const Observation& seen) { return seen.keyframe == merged.from.anchor; });
  const Observation first = by_anchor == own.end() ? own.front() : *by_anchor;
  Keyframe& anchor = keyframe_ref(first.keyframe);
  const Eigen::Vector3d p_anchor = by_anchor == own.end()
                                       ? Eigen::Vector3d(anchor.T_world_camera.inverse() * p_world)
                                       : merged.from.p_anchor;
  landmarks_[merged.from.id.value] = Landmark{merged.from.id, anchor.id, p_anchor, {first}};
  anchor.landmark_of[first.feature] = merged.from.id;
  ++landmark_count_;
  for (const Observation& seen : own) {
    if (seen != first) add_observation(merged.from.id, seen);
  }
}

/// Gives the visits of a component that no loop closure joins any more components of their own. That of the
/// oldest keyframe keeps the number.
void Map::split_components() {
  DisjointSets visits(component_count_);
  for (const LoopClosure& loop : loop_closures_) visits.join(keyframe(loop.a).visit, keyframe(loop.b).visit);
  std::vector<uint32_t> side_of;  // by keyframe
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> component_of;
  std::set<uint32_t> kept;
  for (Keyframe& keyframe : keyframes_) {
    const uint32_t side = visits.find(keyframe.visit);
    side_of.push_back(side);
    const auto [part, is_new] = component_of.try_emplace({keyframe.component, side}, keyframe.component);
    if (is_new && !kept.insert(keyframe.component).second) {
      part->second = component_count_++;
      keyframe.begins_component = true;
    }
    keyframe.component = part->second;
  }
  split_landmarks(side_of);
}

/// Splits the landmarks that keyframes of different sides observe: those of each side but the anchor's get
/// one of their own.
void Map::split_landmarks(const std::vector<uint32_t>& side_of) {
  for (const LandmarkId id : landmark_ids()) {
    std::map<uint32_t, std::vector<Observation>> others;
    const uint32_t own = side_of[landmark(id).anchor.value];
    for (const Observation& seen : landmark(id).observations) {
      if (side_of[seen.keyframe.value] != own) others[side_of[seen.keyframe.value]].push_back(seen);
    }
    for (const auto& [side, moved] : others) split(id, moved);
  }
}

/// Splits the landmarks that are observed before and after an interruption between the ends of a loop closure
/// within one visit, unless another loop closure spans that, too.
void Map::split_tracks(const LoopEnds& loop) {
  const auto [first, last] = std::minmax(loop.a, loop.b);
  for (const LandmarkId id : landmark_ids()) {
    std::vector<KeyframeId> observers;
    for (const Observation& seen : landmark(id).observations) observers.push_back(seen.keyframe);
    std::sort(observers.begin(), observers.end());
    for (size_t i = 1; i < observers.size(); ++i) {
      const KeyframeId before = observers[i - 1], after = observers[i];
      const bool interrupted = after.value - before.value > kInterruption && before < last && after > first;
      const auto spans = [&, first = before, last = after](const LoopClosure& other) {
        const auto [older, newer] = std::minmax(other.a, other.b);
        return older.value <= first.value + kInterruption && newer.value + kInterruption >= last.value;
      };
      if (!interrupted || std::any_of(loop_closures_.begin(), loop_closures_.end(), spans)) continue;
      std::vector<Observation> moved;
      const bool anchor_is_older = landmark(id).anchor <= before;
      for (const Observation& seen : landmark(id).observations) {
        if ((seen.keyframe <= before) != anchor_is_older) moved.push_back(seen);
      }
      split(id, moved);
      break;
    }
  }
}

/// Makes another landmark of some observations, where the first of them that measured depth saw it; without
/// depth they observe none.
void Map::split(LandmarkId id, const std::vector<Observation>& moved) {
  const Eigen::Vector3d p_world = this->p_world(id);
  for (const Observation& seen : moved) remove_observation(id, seen);
  const auto measured = std::find_if(moved.begin(), moved.end(), [&](const Observation& seen) {
    const Features& features = *keyframe(seen.keyframe).features;
    return seen.feature < features.depths_m.size() && features.depths_m[seen.feature] > 0 &&
           (keyframe(seen.keyframe).T_world_camera.inverse() * p_world).z() > 0;
  });
  LandmarkId own;
  if (measured != moved.end()) {
    const Keyframe& anchor = keyframe(measured->keyframe);
    // The direction is right, since it was observed there; the distance may be that of the other visit.
    const Eigen::Vector3d p_anchor = anchor.T_world_camera.inverse() * p_world;
    const auto depth_m = static_cast<double>(anchor.features->depths_m[measured->feature]);
    own = add_landmark(anchor.id, measured->feature, p_anchor * (depth_m / p_anchor.z()));
    for (const Observation& seen : moved) add_observation(own, seen);
  }
  std::set<KeyframeId> observers;
  for (const Observation& seen : moved) observers.insert(seen.keyframe);
  for (auto& [from, merged] : merged_into_) {
    if (merged.into == id && own.valid() && observers.contains(merged.observer)) merged.into = own;
  }
}

}  // namespace kinloop
