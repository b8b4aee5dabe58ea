#include "kinloop/loop/relocalize.hpp"

#include "kinloop/core/random.hpp"

namespace kinloop {

std::optional<TrackedFrame> relocalize(const Frame& frame, const BowVector& bow, const Map& map,
                                       const PlaceIndex& index, const PinholeCamera& camera,
                                       const LocalMapOptions& local_map, const LoopOptions& options,
                                       const TrackingOptions& tracking, uint64_t seed) {
  for (const auto& candidate : index.query(bow, static_cast<size_t>(options.max_candidates))) {
    const LocalMap candidate_map = make_local_map(map, candidate.keyframe, local_map);
    auto result = recognize_place(frame, candidate_map, camera, options, tracking,
                                  hash(seed, candidate.keyframe.value));
    if (result) return result;
  }
  return std::nullopt;
}

}  // namespace kinloop
