#include "kinloop/loop/place_recognition.hpp"

#include "kinloop/core/random.hpp"
#include "kinloop/loop/relocalize.hpp"

namespace kinloop {

BowVector PlaceRecognition::bow_of(const Features& features) const {
  return vocabulary_.bow_of(vocabulary_.quantize(features.descriptors).words);
}

void PlaceRecognition::add(const Keyframe& keyframe) {
  QuantizedFeatures quantized = vocabulary_.quantize(keyframe.features->descriptors);
  index_.add(keyframe.id, vocabulary_.bow_of(quantized.words));
  if (keyframe.id.value >= nodes_.size()) nodes_.resize(keyframe.id.value + 1);
  nodes_[keyframe.id.value] = std::move(quantized.nodes);
}

std::optional<TrackedFrame> PlaceRecognition::relocalize(const Frame& frame, const Map& map) const {
  auto found = kinloop::relocalize(frame, bow_of(*frame.features), {map, index_, sensor_, options_},
                                   hash(options_.seed, frame.id.value));
  if (found) found->outcome = TrackingOutcome::kRelocalized;
  return found;
}

std::optional<TrackedFrame> PlaceRecognition::locate_near(const Frame& frame, const Map& map,
                                                          KeyframeId reference,
                                                          const SE3& T_reference_camera) const {
  const LocalMap local_map = make_local_map(map, reference, options_.local_map);
  TrackedFrame result = track_local_map({frame, local_map, sensor_, options_.tracking}, T_reference_camera,
                                        options_.loop.window_px);
  const bool confident =
      result.evidence.inliers >= options_.tracking.min_confident_inliers &&
      has_sufficient_inlier_ratio(result, *frame.features, options_.tracking.min_inlier_ratio);
  if (!confident) return std::nullopt;
  return result;
}

IndexedView PlaceRecognition::indexed_view(const Keyframe& keyframe) const {
  return {*keyframe.features, nodes_[keyframe.id.value]};
}

LoopCandidates PlaceRecognition::find_loops(const Map& map, KeyframeId keyframe) {
  LoopDetection detected = find_loop_candidates(map, index_, keyframe, history_, options_.loop);
  history_ = std::move(detected.history);
  return make_loop_candidates(map, keyframe, propose_loops(map, keyframe, detected.keyframes),
                              options_.local_map);
}

std::vector<ProposedLoop> PlaceRecognition::propose_loops(const Map& map, KeyframeId id,
                                                          const std::vector<KeyframeId>& candidates) const {
  std::vector<ProposedLoop> proposed;
  if (candidates.empty()) return proposed;
  const Keyframe& keyframe = map.keyframe(id);
  const auto travelled_m = travelled_distances(map, id);
  const uint64_t seed = hash(options_.seed, keyframe.frame.value);
  for (const KeyframeId candidate : candidates) {
    const Keyframe& reference = map.keyframe(candidate);
    const auto predicted = predict_view(map, candidate, id, travelled_m[candidate.value]);
    if (predicted &&
        !may_overlap(*reference.features, *predicted, sensor_.camera, options_.tracking.pnp.min_inliers))
      continue;
    const auto pose = propose_pose({indexed_view(reference), indexed_view(keyframe), predicted}, sensor_,
                                   options_.tracking, hash(seed, candidate.value));
    if (pose) proposed.push_back({candidate, *pose, predicted});
  }
  return proposed;
}

}  // namespace kinloop
