#include "kinloop/mapping/mapper.hpp"

#include "kinloop/mapping/landmark_creation.hpp"
#include "kinloop/mapping/triangulate.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/motion_compensation.hpp"
#include "kinloop/tracking/refine_keypoints.hpp"

namespace kinloop {
namespace {

/// Which keypoints observe a landmark.
std::vector<bool> observed(const Map& map, KeyframeId id) {
  std::vector<bool> result;
  for (const LandmarkId landmark : map.keyframe(id).landmark_of) result.push_back(landmark.valid());
  return result;
}

KeyframeOptions keyframe_options(const FrameTracking& tracking, const KeyframeOptions& keyframe) {
  return tracking.direct ? spaced_for_direct_tracking(keyframe) : keyframe;
}

}  // namespace

bool Mapper::needs_keyframe(const Map& map, const FrameTracking& tracking) const {
  if (tracking.repeat || options_.localize_only) return false;
  if (std::holds_alternative<NewMap>(tracking.outcome)) return true;
  const TrackResult* result = located(tracking.outcome);
  if (result == nullptr) return false;
  const KeyframeCriteria criteria{
      *result, tracking.frame, motions_from_keyframes(map, *result, last_keyframe_),
      frames_since_keyframe(map, tracking.frame.id), count_confirmed_landmarks(map, result->reference)};
  return kinloop::needs_keyframe(criteria, keyframe_options(tracking, options_.keyframe));
}

int Mapper::frames_since_keyframe(const Map& map, FrameId frame) const {
  return static_cast<int>(frame.value - map.keyframe(last_keyframe_).frame.value);
}

bool Mapper::may_need_keyframe(const Map& map, const FrameTracking& tracking) {
  constexpr uint32_t kInterval_frames = 4;  // a tenth of a second: extraction costs more than direct tracking
  const TrackResult& result = *located(tracking.outcome);
  const double moved =
      motion_from_nearest(*tracking.frame.features, motions_from_keyframes(map, result, last_keyframe_),
                          keyframe_options(tracking, options_.keyframe));
  if (moved < kMinKeyframeMotion) return false;
  const FrameId now = tracking.frame.id;
  if (moved <= 1 && now.value - last_check_.value < kInterval_frames) return false;
  last_check_ = now;
  return true;
}

/// The first camera defines the world frame. A new component starts at the last known camera pose, for lack
/// of a better estimate.
KeyframeId Mapper::add_keyframe(Map& map, const FrameTracking& tracking) const {
  const PreparedFrame& frame = tracking.frame;
  if (const TrackResult* result = located(tracking.outcome)) {
    const Keyframe& reference = map.keyframe(result->reference);
    return map.add_keyframe(frame.id, frame.stamp_ns, reference.T_world_camera * result->T_reference_camera,
                            frame.features, reference.component);
  }
  const SE3 T_world_last = map.keyframes().empty() ? SE3{} : map.keyframe(last_keyframe_).T_world_camera;
  return map.add_keyframe(frame.id, frame.stamp_ns, T_world_last, frame.features, map.component_count());
}

/// Moves the keypoints of a new keyframe to where its landmarks are found by their patches in earlier
/// keyframes.
void Mapper::refine_observations(Map& map, KeyframeId id, const LocalMap& known,
                                 const FrameTracking& tracking, const Sensor& sensor) const {
  const Keyframe& keyframe = map.keyframe(id);
  std::vector<LandmarkMatch> matches;
  for (uint32_t feature = 0; feature < keyframe.landmark_of.size(); ++feature) {
    if (keyframe.landmark_of[feature].valid()) matches.push_back({keyframe.landmark_of[feature], feature});
  }
  const Velocity velocity = tracking.motion.velocity();
  const Features refined = refine_keypoints(
      tracking.frame, matches, located(tracking.outcome)->T_reference_camera, {known, sensor, velocity});
  map.set_features(id, std::make_shared<const Features>(deskew_features(refined, sensor, velocity)));
}

KeyframeId Mapper::insert_keyframe(Map& map, const FrameTracking& tracking, const Sensor& sensor) {
  const TrackResult* result = located(tracking.outcome);
  LocalMap known;  // as seen from earlier keyframes
  if (result != nullptr) known = make_local_map(map, result->reference, options_.local_map);
  const KeyframeId id = add_keyframe(map, tracking);
  if (result != nullptr) add_observations(map, id, result->matches);
  match_local_map(map, id, make_local_map(map, id, options_.local_map), sensor.camera, options_.mapping);
  if (result != nullptr) refine_observations(map, id, known, tracking, sensor);
  create_landmarks_from_depth(map, id, sensor.camera, options_.mapping);
  triangulate_landmarks(map, id, sensor.camera, options_.mapping);
  cull_landmarks(map, options_.mapping);
  map.set_patches(id, cut_patches(tracking.frame.octaves, *map.keyframe(id).features, observed(map, id)));
  last_keyframe_ = id;
  return id;
}

}  // namespace kinloop
