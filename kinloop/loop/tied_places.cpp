#include "kinloop/loop/tied_places.hpp"

#include <algorithm>

namespace kinloop {
namespace {

bool is_in(const std::vector<KeyframeId>& group, KeyframeId keyframe) {
  return std::binary_search(group.begin(), group.end(), keyframe);
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

bool KnownPlace::is_tied_to(const std::vector<KeyframeId>& group, int min_landmarks) const {
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
  for (const LoopEdge& loop : map_.loop_edges()) {
    const bool connects = (is_in(keyframes_, loop.a) && is_in(group, loop.b)) ||
                          (is_in(keyframes_, loop.b) && is_in(group, loop.a));
    if (connects) inliers += loop.inliers;
  }
  return inliers;
}

}  // namespace kinloop
