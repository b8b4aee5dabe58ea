#include "kinloop/loop/place_recognition.hpp"

#include "kinloop/core/random.hpp"
#include "kinloop/loop/recognize_place.hpp"
#include "kinloop/tracking/evidence/surface_evidence.hpp"

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
  const PlaceOptions& options = context_.options;
  const uint64_t seed = hash(options.seed, frame.id.value);
  const auto candidates =
      index_.query(bow_of(*frame.features), static_cast<size_t>(options.loop.max_candidates));
  for (const auto& candidate : candidates) {
    const LocalMap local_map = make_local_map(map, candidate.keyframe, options.local_map);
    auto found = recognize_place({frame, local_map, context_.sensor, options.tracking}, options.loop,
                                 hash(seed, candidate.keyframe.value));
    if (!found) continue;
    found->outcome = TrackingOutcome::kRelocalized;
    found->evidence.with_depth = count_with_depth(found->matches, local_map);
    return found;
  }
  return std::nullopt;
}

std::optional<TrackedFrame> PlaceRecognition::locate_near(const Frame& frame, const Map& map,
                                                          KeyframeId reference,
                                                          const SE3& T_reference_camera) const {
  const auto& [sensor, options] = context_;
  const LocalMap local_map = make_local_map(map, reference, options.local_map);
  TrackedFrame result = track_local_map({frame, local_map, sensor, options.tracking}, T_reference_camera,
                                        options.loop.window_px);
  const bool confident =
      result.evidence.inliers >= options.tracking.min_confident_inliers &&
      has_sufficient_inlier_ratio(result, *frame.features, options.tracking.min_inlier_ratio);
  if (!confident) return std::nullopt;
  const SurfaceAgreement surfaces = agreement_with_reference(local_map, frame, result.T_reference_camera);
  if (contradicts_unexpected_pose(surfaces, result, frame)) return std::nullopt;
  return result;
}

IndexedView PlaceRecognition::indexed_view(const Keyframe& keyframe) const {
  return {*keyframe.features, nodes_[keyframe.id.value]};
}

LoopVerificationProblem PlaceRecognition::find_loops(const Map& map, KeyframeId id) const {
  const auto& [sensor, options] = context_;
  const auto candidates = find_loop_candidates(map, index_, id, options.loop);
  const Keyframe& keyframe = map.keyframe(id);
  LoopVerificationProblem problem = make_loop_verification_problem(keyframe);
  if (candidates.empty()) return problem;
  const auto travelled_m = travelled_distances(map, id);
  const uint64_t seed = hash(options.seed, keyframe.frame.value);
  for (const KeyframeId candidate : candidates) {
    const Keyframe& reference = map.keyframe(candidate);
    const auto predicted = predict_view(map, candidate, id, travelled_m[candidate.value]);
    if (predicted &&
        !may_overlap(*reference.features, *predicted, sensor.camera, options.tracking.pnp.min_inliers))
      continue;
    const auto T_a_b = propose_pose({indexed_view(reference), indexed_view(keyframe), predicted}, context_,
                                    hash(seed, candidate.value));
    if (!T_a_b) continue;
    const LoopClosure hypothesis{.a = candidate, .b = id, .T_a_b = *T_a_b};
    problem.candidates.push_back({hypothesis, predicted, make_local_map(map, candidate, options.local_map)});
  }
  return problem;
}

}  // namespace kinloop
