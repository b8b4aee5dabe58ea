#include "kinloop/map/covisibility.hpp"

#include <algorithm>

namespace kinloop {

void Covisibility::add(std::span<const Observation> observations) {
  for (size_t i = 1; i < observations.size(); ++i) add(observations[i].keyframe, observations.first(i));
}

void Covisibility::remove(std::span<const Observation> observations) {
  for (size_t i = 1; i < observations.size(); ++i) remove(observations[i].keyframe, observations.first(i));
}

void Covisibility::change(KeyframeId keyframe, std::span<const Observation> others, int32_t by) {
  for (const Observation& other : others) {
    change(neighbours_[keyframe.value], other.keyframe, by);
    change(neighbours_[other.keyframe.value], keyframe, by);
  }
}

void Covisibility::change(Neighbours& neighbours, KeyframeId other, int32_t by) {
  auto found = std::lower_bound(
      neighbours.begin(), neighbours.end(), other.value,
      [](const Neighbour& neighbour, uint32_t keyframe) { return neighbour.keyframe < keyframe; });
  if (found == neighbours.end() || found->keyframe != other.value)
    found = neighbours.insert(found, {other.value, 0});
  found->shared += by;
  if (found->shared == 0) neighbours.erase(found);
}

std::vector<std::pair<KeyframeId, int>> Covisibility::neighbours(KeyframeId keyframe, int min_shared) const {
  std::vector<std::pair<KeyframeId, int>> found;
  const Neighbours& all = neighbours_[keyframe.value];
  found.reserve(all.size());
  for (const Neighbour& neighbour : all) {
    if (neighbour.shared >= min_shared) found.emplace_back(KeyframeId{neighbour.keyframe}, neighbour.shared);
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  return found;
}

}  // namespace kinloop
