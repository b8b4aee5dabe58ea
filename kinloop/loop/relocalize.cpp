#include "kinloop/loop/relocalize.hpp"

#include "kinloop/core/random.hpp"

namespace kinloop {

std::optional<TrackedFrame> relocalize(const Frame& frame, const BowVector& bow, const PlaceSearch& search,
                                       uint64_t seed) {
  const auto& [map, index, sensor, options] = search;
  for (const auto& candidate : index.query(bow, static_cast<size_t>(options.loop.max_candidates))) {
    const LocalMap local_map = make_local_map(map, candidate.keyframe, options.local_map);
    auto result = recognize_place({frame, local_map, sensor, options.tracking}, options.loop,
                                  hash(seed, candidate.keyframe.value));
    if (result) return result;
  }
  return std::nullopt;
}

}  // namespace kinloop
