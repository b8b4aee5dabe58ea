#include "kinloop/loop/close_loop.hpp"

#include "kinloop/base/random.hpp"

namespace kinloop {
namespace {

LoopClosure closure_of(const Map& map, const Keyframe& keyframe, const TrackResult& found,
                       const LoopOptions& options) {
  LoopClosure closure;
  closure.edge = {found.reference, keyframe.id, found.T_reference_camera,
                  edge_information(found.stats.inliers, options), found.stats.inliers};
  for (const LandmarkMatch& match : found.matches) {
    const LandmarkId newer = keyframe.landmark_of[match.feature];
    if (newer.valid() && newer != match.landmark && map.contains(match.landmark)) {
      closure.merges.emplace_back(newer, match.landmark);
    }
  }
  return closure;
}

}  // namespace

std::optional<LoopClosure> verify_loop(const Map& map, KeyframeId id,
                                       const std::vector<KeyframeId>& candidates, const PinholeCamera& camera,
                                       const LocalViewOptions& view, const LoopOptions& options,
                                       const TrackingOptions& tracking, uint64_t seed) {
  const Keyframe& keyframe = map.keyframe(id);
  PreparedFrame frame;
  frame.id = keyframe.frame;
  frame.stamp_ns = keyframe.stamp_ns;
  frame.features = keyframe.features;
  for (const KeyframeId candidate : candidates) {
    const LocalView around = make_local_view(map, candidate, view);
    const auto found = recognize_place(frame, around, camera, options, tracking, hash(seed, candidate.value));
    if (found) return closure_of(map, keyframe, *found, options);
  }
  return std::nullopt;
}

}  // namespace kinloop
