#include "kinloop/loop/verify_loop.hpp"

#include "kinloop/base/random.hpp"

namespace kinloop {

LoopCandidates make_loop_candidates(const Map& map, KeyframeId id, const std::vector<KeyframeId>& keyframes,
                                    const LocalMapOptions& local_map, uint64_t seed) {
  const Keyframe& keyframe = map.keyframe(id);
  LoopCandidates candidates;
  candidates.keyframe = id;
  candidates.frame.id = keyframe.frame;
  candidates.frame.stamp_ns = keyframe.stamp_ns;
  candidates.frame.features = keyframe.features;
  candidates.seed = seed;
  for (const KeyframeId candidate : keyframes) {
    candidates.local_maps.push_back(make_local_map(map, candidate, local_map));
  }
  return candidates;
}

std::optional<VerifiedLoop> verify_loop(const LoopCandidates& candidates, const PinholeCamera& camera,
                                        const LoopOptions& options, const TrackingOptions& tracking) {
  for (const LocalMap& place : candidates.local_maps) {
    const uint64_t seed = hash(candidates.seed, place.reference.value);
    auto found = recognize_place(candidates.frame, place, camera, options, tracking, seed);
    if (found) return VerifiedLoop{candidates.keyframe, std::move(*found)};
  }
  return std::nullopt;
}

LoopConstraint make_loop_constraint(const Map& map, const VerifiedLoop& loop, const LoopOptions& options) {
  const auto& [id, found] = loop;
  LoopConstraint constraint;
  constraint.edge = {found.reference, id, found.T_reference_camera,
                     edge_information(found.stats.inliers, options), found.stats.inliers};
  for (const LandmarkMatch& match : found.matches) {
    const LandmarkId newer = map.keyframe(id).landmark_of[match.feature];
    if (newer.valid() && newer != match.landmark && map.contains(match.landmark)) {
      constraint.merges.emplace_back(newer, match.landmark);
    }
  }
  return constraint;
}

}  // namespace kinloop
