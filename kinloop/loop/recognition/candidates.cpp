#include "kinloop/loop/recognition/candidates.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

namespace kinloop {
namespace {

bool is_in(const std::vector<KeyframeId>& group, KeyframeId keyframe) {
  return std::binary_search(group.begin(), group.end(), keyframe);
}

/// Returns the lowest similarity of the keyframe to a covisible one: the local reference for "the same
/// place".
double min_covisible_score(const PlaceIndex& index, KeyframeId keyframe,
                           const std::vector<std::pair<KeyframeId, int>>& neighbours) {
  double lowest = 1.0;
  for (const auto& [neighbour, shared] : neighbours) {
    lowest = std::min(lowest, similarity(index.bow_of(keyframe), index.bow_of(neighbour)));
  }
  return neighbours.empty() ? 0.0 : lowest;
}

bool overlap(const std::vector<KeyframeId>& a, const std::vector<KeyframeId>& b) {
  std::vector<KeyframeId> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return !common.empty();
}

}  // namespace

std::vector<KeyframeId> covisible_group(const Map& map, KeyframeId keyframe) {
  std::vector<KeyframeId> group{keyframe};
  for (const auto& [neighbour, shared] : map.covisible_keyframes(keyframe, kMinCovisibleLandmarks))
    group.push_back(neighbour);
  std::sort(group.begin(), group.end());
  return group;
}

KnownPlace::KnownPlace(const Map& map, std::vector<KeyframeId> keyframes)
    : map_(map), keyframes_(std::move(keyframes)) {
  for (const KeyframeId id : keyframes_) {
    for (const LandmarkId landmark : map.keyframe(id).landmark_of) {
      if (!landmark.valid()) continue;
      if (landmark.value >= observed_.size()) observed_.resize(landmark.value + 1, false);
      observed_[landmark.value] = true;
    }
  }
}

bool KnownPlace::shares_landmarks_with(const std::vector<KeyframeId>& group, int min_landmarks) const {
  int tied = count_loop_inliers(group);
  std::vector<bool> uncounted = observed_;
  for (const KeyframeId id : group) {
    if (tied >= min_landmarks) return true;
    for (const LandmarkId landmark : map_.keyframe(id).landmark_of) {
      if (!landmark.valid() || landmark.value >= uncounted.size() || !uncounted[landmark.value]) continue;
      uncounted[landmark.value] = false;
      ++tied;
    }
  }
  return tied >= min_landmarks;
}

int KnownPlace::count_loop_inliers(const std::vector<KeyframeId>& group) const {
  int inliers = 0;
  for (const LoopClosure& loop : map_.loop_closures()) {
    const bool connects = (is_in(keyframes_, loop.a) && is_in(group, loop.b)) ||
                          (is_in(keyframes_, loop.b) && is_in(group, loop.a));
    if (connects) inliers += loop.evidence.inliers;
  }
  return inliers;
}

std::vector<KeyframeId> find_loop_candidates(const Map& map, const PlaceIndex& index, KeyframeId keyframe,
                                             const LoopOptions& options) {
  const auto neighbours = map.covisible_keyframes(keyframe, kMinCovisibleLandmarks);
  const double min_score = options.min_score_ratio * min_covisible_score(index, keyframe, neighbours);
  std::vector<bool> excluded(map.keyframes().size(), false);
  for (const auto& [neighbour, shared] : neighbours) excluded[neighbour.value] = true;
  const uint32_t component = map.keyframe(keyframe).component;
  const auto allowed = [&](KeyframeId id) {
    const bool old_enough = id.value + static_cast<uint32_t>(options.min_gap_keyframes) <= keyframe.value;
    const bool other_component = id != keyframe && map.keyframe(id).component != component;
    return (old_enough || other_component) && !excluded[id.value];
  };

  std::vector<KeyframeId> candidates;
  std::optional<KnownPlace> place;
  std::vector<std::vector<KeyframeId>> chosen;  // the groups of the candidates
  const auto& landmarks = map.keyframe(keyframe).landmark_of;
  const auto observed_landmarks = static_cast<int>(
      std::count_if(landmarks.begin(), landmarks.end(), [](LandmarkId id) { return id.valid(); }));
  const auto max_results = static_cast<size_t>(options.max_candidates);
  for (const auto& [candidate, score] : index.query(index.bow_of(keyframe), max_results, allowed)) {
    if (score < min_score) continue;
    std::vector<KeyframeId> group = covisible_group(map, candidate);
    // Of the keyframes that show one place, only the most similar is verified.
    const bool known_place = std::any_of(chosen.begin(), chosen.end(),
                                         [&](const auto& keyframes) { return overlap(group, keyframes); });
    if (known_place) continue;
    if (!place) place.emplace(map, covisible_group(map, keyframe));
    if (place->shares_landmarks_with(group, observed_landmarks)) continue;
    candidates.push_back(candidate);
    chosen.push_back(std::move(group));
  }
  return candidates;
}

}  // namespace kinloop
