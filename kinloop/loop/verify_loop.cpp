#include "kinloop/loop/verify_loop.hpp"

namespace kinloop {

LoopCandidates make_loop_candidates(const Map& map, KeyframeId id, const std::vector<ProposedLoop>& proposed,
                                    const LocalMapOptions& local_map) {
  const Keyframe& keyframe = map.keyframe(id);
  LoopCandidates candidates;
  candidates.keyframe = id;
  candidates.frame.id = keyframe.frame;
  candidates.frame.stamp_ns = keyframe.stamp_ns;
  candidates.frame.features = keyframe.features;
  for (const ProposedLoop& loop : proposed) {
    candidates.places.push_back({loop, make_local_map(map, loop.reference, local_map)});
  }
  return candidates;
}

std::optional<VerifiedLoop> verify_loop(const LoopCandidates& candidates, const Sensor& sensor,
                                        const LoopOptions& options, const TrackingOptions& tracking) {
  for (const auto& [proposed, local_map] : candidates.places) {
    auto found =
        confirm_pose({candidates.frame, local_map, sensor, tracking}, proposed.T_reference_camera, options);
    if (!found) continue;
    if (proposed.predicted && !is_explained_by_drift(*proposed.predicted, found->T_reference_camera))
      continue;
    return VerifiedLoop{candidates.keyframe, std::move(*found)};
  }
  return std::nullopt;
}

LoopConstraint make_loop_constraint(const Map& map, const VerifiedLoop& loop, const LoopOptions& options) {
  const auto& [id, found] = loop;
  LoopConstraint constraint;
  constraint.edge = {found.reference, id, found.T_reference_camera,
                     edge_information(found.evidence.inliers, options), found.evidence.inliers};
  for (const LandmarkMatch& match : found.matches) {
    const LandmarkId newer = map.keyframe(id).landmark_of[match.feature];
    if (newer.valid() && newer != match.landmark && map.contains(match.landmark)) {
      constraint.merges.emplace_back(newer, match.landmark);
    }
  }
  return constraint;
}

}  // namespace kinloop
