#include "kinloop/loop/close_loop.hpp"

#include "kinloop/base/random.hpp"

namespace kinloop {

LoopQuestion loop_question(const Map& map, KeyframeId id, const std::vector<KeyframeId>& candidates,
                           const LocalViewOptions& view, uint64_t seed) {
  const Keyframe& keyframe = map.keyframe(id);
  LoopQuestion question;
  question.keyframe = id;
  question.frame.id = keyframe.frame;
  question.frame.stamp_ns = keyframe.stamp_ns;
  question.frame.features = keyframe.features;
  question.seed = seed;
  for (const KeyframeId candidate : candidates) {
    question.places.push_back(make_local_view(map, candidate, view));
  }
  return question;
}

std::optional<LoopAnswer> verify_loop(const LoopQuestion& question, const PinholeCamera& camera,
                                      const LoopOptions& options, const TrackingOptions& tracking) {
  for (const LocalView& place : question.places) {
    const uint64_t seed = hash(question.seed, place.reference.value);
    auto found = recognize_place(question.frame, place, camera, options, tracking, seed);
    if (found) return LoopAnswer{question.keyframe, std::move(*found)};
  }
  return std::nullopt;
}

LoopClosure closure_of(const Map& map, const LoopAnswer& answer, const LoopOptions& options) {
  const auto& [id, found] = answer;
  LoopClosure closure;
  closure.edge = {found.reference, id, found.T_reference_camera,
                  edge_information(found.stats.inliers, options), found.stats.inliers};
  for (const LandmarkMatch& match : found.matches) {
    const LandmarkId newer = map.keyframe(id).landmark_of[match.feature];
    if (newer.valid() && newer != match.landmark && map.contains(match.landmark)) {
      closure.merges.emplace_back(newer, match.landmark);
    }
  }
  return closure;
}

}  // namespace kinloop
