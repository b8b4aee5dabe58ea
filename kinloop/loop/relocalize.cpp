#include "kinloop/loop/relocalize.hpp"

#include "kinloop/base/random.hpp"

namespace kinloop {

std::optional<TrackResult> relocalize(const PreparedFrame& frame, const BowVector& bow, const Map& map,
                                      const PlaceIndex& index, const PinholeCamera& camera,
                                      const LocalViewOptions& view, const LoopOptions& options,
                                      const TrackingOptions& tracking, uint64_t seed) {
  for (const auto& candidate : index.query(bow, static_cast<size_t>(options.max_candidates))) {
    const LocalView around = make_local_view(map, candidate.keyframe, view);
    auto result =
        recognize_place(frame, around, camera, options, tracking, hash(seed, candidate.keyframe.value));
    if (result) return result;
  }
  return std::nullopt;
}

}  // namespace kinloop
