#include "kinloop/slam/mapper.hpp"

#include "kinloop/mapping/landmark_creation.hpp"
#include "kinloop/mapping/triangulate.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"

namespace kinloop {

bool Mapper::needs_keyframe(const Map& map, const FrameTracking& tracking) {
  if (tracking.repeat || options_.localize_only) return false;
  ++frames_since_keyframe_;
  if (std::holds_alternative<NewMap>(tracking.outcome)) return true;
  const TrackResult* result = located(tracking.outcome);
  if (result == nullptr) return false;
  const KeyframeCriteria criteria{*result, tracking.frame,
                                  motions_from_keyframes(map, *result, last_keyframe_),
                                  frames_since_keyframe_, count_confirmed_landmarks(map, result->reference)};
  return kinloop::needs_keyframe(criteria, options_.tracking.keyframe);
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

KeyframeId Mapper::insert_keyframe(Map& map, const FrameTracking& tracking) {
  const KeyframeId id = add_keyframe(map, tracking);
  if (const TrackResult* result = located(tracking.outcome)) add_observations(map, id, result->matches);
  match_local_map(map, id, make_local_map(map, id, options_.local_map), camera_, options_.mapping);
  create_landmarks_from_depth(map, id, camera_, options_.mapping);
  triangulate_landmarks(map, id, camera_, options_.mapping);
  cull_landmarks(map, options_.mapping);
  last_keyframe_ = id;
  frames_since_keyframe_ = 0;
  return id;
}

}  // namespace kinloop
