#include "kinloop/loop/recognition/place_recognition.hpp"

#include <algorithm>

#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/loop/recognition/recognize_place.hpp"
#include "kinloop/loop/verification/relative_scale.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/view_difference.hpp"
#include "kinloop/tracking/evidence/surface_evidence.hpp"

namespace kinloop {
namespace {

/// The id after those of all keyframes.
KeyframeId end_of(const Map& map) {
  return KeyframeId{static_cast<uint32_t>(map.keyframes().size())};
}

/// Whether the map says that a keyframe shows the place where the frame was found.
bool shows_place_of(const TrackedFrame& found, KeyframeId keyframe, const Map& map) {
  constexpr double kMaxDistance_m = 0.5;
  if (map.keyframe(keyframe).component != map.keyframe(found.reference).component) return false;
  const double distance_m =
      (found.world(map).translation - map.keyframe(keyframe).T_world_camera.translation).norm();
  const auto group = covisible_group(map, found.reference);
  return distance_m < kMaxDistance_m || std::binary_search(group.begin(), group.end(), keyframe);
}

/// Whether drift of the map explains the difference between two poses of one frame.
bool agree(const TrackedFrame& a, const TrackedFrame& b, const Map& map) {
  const auto predicted = RelativePoses(map, a.reference).pose_of(b.reference);
  return predicted && is_explained(*predicted, a.T_reference_camera * b.T_reference_camera.inverse());
}

/// Whether so many more landmarks agree with one pose of a frame that the other is a chance.
bool fits_better(const TrackedFrame& pose, const TrackedFrame& other) {
  constexpr double kMaxRatio = 0.7;
  return other.evidence.inliers < kMaxRatio * pose.evidence.inliers;
}

/// Whether a keyframe shows something else than others.
bool is_apart(const Map& map, KeyframeId id, const std::vector<KeyframeId>& others) {
  constexpr double kSpacing_m = 0.5, kSpacing_rad = 0.5;
  const SE3& T_world_camera = map.keyframe(id).T_world_camera;
  return std::none_of(others.begin(), others.end(), [&](KeyframeId other) {
    const SE3 T_other_camera = map.keyframe(other).T_world_camera.inverse() * T_world_camera;
    return T_other_camera.translation.norm() < kSpacing_m && T_other_camera.angle_rad() < kSpacing_rad;
  });
}

/// Keyframes of a component around a position, the nearest first, that show different things.
std::vector<KeyframeId> views_around(const Map& map, uint32_t component, const Eigen::Vector3d& p_world) {
  constexpr double kMaxDistance_m = 5;
  constexpr size_t kMaxCount = 16;
  std::vector<std::pair<double, KeyframeId>> near;
  for (const Keyframe& keyframe : map.keyframes()) {
    const double away_m = (keyframe.T_world_camera.translation - p_world).norm();
    if (keyframe.component == component && !keyframe.withdrawn && away_m < kMaxDistance_m)
      near.emplace_back(away_m, keyframe.id);
  }
  std::sort(near.begin(), near.end());
  std::vector<KeyframeId> views;
  for (const auto& [away_m, id] : near) {
    if (is_apart(map, id, views)) views.push_back(id);
    if (views.size() == kMaxCount) break;
  }
  return views;
}

/// Whether the frame itself contradicts the pose that was found for it.
bool contradicts_pose(const TrackedFrame& found, const TrackingInput& in, const Map& map) {
  const LocatedView located{map.keyframe(found.reference).component, found.world(map), *in.frame.features};
  LocationEvidence evidence = compare_with_views(map, end_of(map), located, in.sensor);
  evidence.scale = measure_scale(in, found.T_reference_camera);
  LocationCheck check;
  check.add(evidence, false);
  return check.is_contradicted();
}

}  // namespace

BowVector PlaceRecognition::bow_of(const Features& features) const {
  return vocabulary_.bow_of(vocabulary_.quantize(features.descriptors).words);
}

void PlaceRecognition::add(const Keyframe& keyframe) {
  QuantizedFeatures quantized = vocabulary_.quantize(keyframe.features->descriptors);
  index_.add(keyframe.id, vocabulary_.bow_of(quantized.words));
  if (keyframe.id.value >= nodes_.size()) nodes_.resize(keyframe.id.value + 1);
  nodes_[keyframe.id.value] = std::move(quantized.nodes);
}

/// Returns the pose of the frame if it shows the place of this keyframe and nothing around contradicts it.
std::optional<TrackedFrame> PlaceRecognition::locate_at(KeyframeId candidate, const Frame& frame,
                                                        const Map& map) const {
  const auto& [sensor, options] = context_;
  const LocalMap local_map = make_local_map(map, candidate, options.local_map);
  const TrackingInput in{frame, local_map, sensor, options.tracking};
  const uint64_t seed = hash(options.seed, frame.id.value);
  auto found = recognize_place(in, options.loop, hash(seed, candidate.value));
  if (!found) return std::nullopt;
  if (contradicts_pose(*found, in, map)) return std::nullopt;
  found->outcome = TrackingOutcome::kRelocalized;
  found->evidence.with_depth = count_with_depth(found->matches, local_map);
  return found;
}

std::optional<TrackedFrame> PlaceRecognition::relocalize(const Frame& frame, const Map& map) const {
  constexpr size_t kLookedAt = 4;  // times the candidates
  constexpr int kMaxRivals = 2;    // their verification takes time
  const LoopOptions& options = context_.options.loop;
  const auto max_candidates = static_cast<size_t>(options.max_candidates);
  const auto candidates = index_.query(bow_of(*frame.features), kLookedAt * max_candidates);
  std::optional<TrackedFrame> best;
  double best_score = 0;
  int rivals = 0;
  for (size_t i = 0; i < candidates.size() && rivals < kMaxRivals; ++i) {
    const auto& [keyframe, score] = candidates[i];
    if (!best) {
      if (i >= max_candidates) break;
      best = locate_at(keyframe, frame, map);
      best_score = score;
      continue;
    }
    if (score < options.min_score_ratio * best_score) break;
    if (shows_place_of(*best, keyframe, map)) continue;
    ++rivals;
    auto rival = locate_at(keyframe, frame, map);
    if (!rival || agree(*best, *rival, map)) continue;
    if (fits_better(*best, *rival)) continue;
    if (!fits_better(*rival, *best)) return std::nullopt;
    best = std::move(rival);
  }
  if (best && is_aliased(map.keyframe(best->reference).component, best->world(map).translation, map))
    return std::nullopt;
  return best;
}

bool PlaceRecognition::is_aliased(KeyframeId id, const Map& map) const {
  const Keyframe& keyframe = map.keyframe(id);
  return is_aliased(keyframe.component, keyframe.T_world_camera.translation, map);
}

/// Asks the views around: where something repeats itself, the camera has not looked at all of it alike.
bool PlaceRecognition::is_aliased(uint32_t component, const Eigen::Vector3d& p_world, const Map& map) const {
  const auto views = views_around(map, component, p_world);
  return std::any_of(views.begin(), views.end(), [&](KeyframeId view) { return is_view_aliased(view, map); });
}

/// Remembers what was found in the map of one epoch, so that only new keyframes are compared.
bool PlaceRecognition::is_view_aliased(KeyframeId id, const Map& map) const {
  AliasSearch& search = aliases_[id];
  if (search.epoch != map.epoch()) search = {.epoch = map.epoch()};
  if (!search.found) search.found = find_alias(id, KeyframeId{search.compared}, map);
  search.compared = end_of(map).value;
  return search.found;
}

/// Whether a keyframe is recognized in a part of its component that it does not show, by those from `first`
/// on.
bool PlaceRecognition::find_alias(KeyframeId id, KeyframeId first, const Map& map) const {
  constexpr size_t kLookedAt = 60, kMaxVerified = 8;  // verification takes time
  const Keyframe& keyframe = map.keyframe(id);
  const auto group = covisible_group(map, id);  // they show the same place
  std::vector<KeyframeId> verified;
  for (const auto& [other, score] : index_.query(index_.bow_of(id), kLookedAt)) {
    const Keyframe& view = map.keyframe(other);
    if (other < first || view.withdrawn || view.component != keyframe.component) continue;
    if (view_difference(view.T_world_camera, keyframe.T_world_camera)) continue;
    if (std::binary_search(group.begin(), group.end(), other) || !is_apart(map, other, verified)) continue;
    if (looks_like(keyframe, view, map)) return true;
    verified.push_back(other);
    if (verified.size() == kMaxVerified) break;
  }
  return false;
}

/// Whether a keyframe is recognized at another one, at a pose that drift of the map does not explain.
bool PlaceRecognition::looks_like(const Keyframe& keyframe, const Keyframe& other, const Map& map) const {
  const auto& [sensor, options] = context_;
  const auto T_other_keyframe = propose_pose({indexed_view(other), indexed_view(keyframe), std::nullopt},
                                             context_, hash(options.seed, keyframe.id.value));
  if (!T_other_keyframe) return false;
  const LocalMap local_map = make_local_map(map, other.id, options.local_map);
  const Frame frame = make_loop_verification_problem(keyframe).frame;
  const auto found =
      confirm_pose({frame, local_map, sensor, options.tracking}, *T_other_keyframe, options.loop);
  TrackedFrame itself;
  itself.reference = keyframe.id;
  return found && !agree(itself, *found, map);
}

LocationEvidence PlaceRecognition::examine(const TrackedFrame& tracked, const Map& map,
                                           KeyframeId end) const {
  const auto& [sensor, options] = context_;
  const LocatedView located{map.keyframe(tracked.reference).component, tracked.world(map),
                            tracked.features()};
  LocationEvidence evidence = compare_with_views(map, end, located, sensor);
  // Landmarks that this visit has made have the scale of its own depth.
  if (tracked.reference < end) {
    const LocalMap local_map = make_local_map(map, tracked.reference, options.local_map);
    evidence.scale =
        measure_scale({*tracked.frame, local_map, sensor, options.tracking}, tracked.T_reference_camera);
  }
  return evidence;
}

std::optional<TrackedFrame> PlaceRecognition::locate_near(const Frame& frame, const Map& map,
                                                          KeyframeId reference,
                                                          const SE3& T_reference_camera) const {
  const auto& [sensor, options] = context_;
  const LocalMap local_map = make_local_map(map, reference, options.local_map);
  const TrackingInput in{frame, local_map, sensor, options.tracking};
  TrackedFrame result = track_local_map(in, T_reference_camera, options.loop.window_px);
  const bool confident =
      result.evidence.inliers >= options.tracking.min_confident_inliers &&
      has_sufficient_inlier_ratio(result, *frame.features, options.tracking.min_inlier_ratio);
  if (!confident) return std::nullopt;
  const SurfaceAgreement surfaces = agreement_with_reference(local_map, frame, result.T_reference_camera);
  if (contradicts_unexpected_pose(surfaces, result, frame) || contradicts_pose(result, in, map))
    return std::nullopt;
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
  const RelativePoses poses(map, id);
  const uint64_t seed = hash(options.seed, keyframe.frame.value);
  for (const KeyframeId candidate : candidates) {
    const Keyframe& reference = map.keyframe(candidate);
    const auto predicted = poses.seen_from(candidate);
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
