// Slam's keyframes: which frames become one, and what that adds to the map.

#include "kinloop/mapping/landmark_creation.hpp"
#include "kinloop/mapping/triangulate.hpp"
#include "kinloop/slam/slam.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"

namespace kinloop {

bool Slam::should_insert_keyframe(const PreparedFrame& frame, const TrackResult& result) const {
  if (result.status == TrackStatus::kLost) return false;
  if (result.reference == next_keyframe_id()) return true;
  const KeyframeCriteria criteria{result, frame, motions_from_keyframes(map_, result, last_keyframe_),
                                  frames_since_keyframe_,
                                  count_confirmed_landmarks(map_, local_map_.reference)};
  return needs_keyframe(criteria, options_.tracking.keyframe);
}

/// The world begins at the first camera; a new component is put, for want of better, where the camera was
/// last.
KeyframeId Slam::add_keyframe(const PreparedFrame& frame, const TrackResult& result) {
  if (result.reference != next_keyframe_id()) {
    const Keyframe& reference = map_.keyframe(result.reference);
    return map_.add_keyframe(frame.id, frame.stamp_ns, reference.T_world_camera * result.T_reference_camera,
                             frame.features, reference.component);
  }
  const SE3 T_world_last = map_.keyframes().empty() ? SE3{} : map_.keyframe(last_keyframe_).T_world_camera;
  return map_.add_keyframe(frame.id, frame.stamp_ns, T_world_last, frame.features, map_.component_count());
}

KeyframeId Slam::insert_keyframe(const PreparedFrame& frame, const TrackResult& result) {
  const Stopwatch watch;
  const KeyframeId id = add_keyframe(frame, result);
  add_observations(map_, id, result.matches);
  match_local_map(map_, id, make_local_map(map_, id, options_.local_map), camera_.color, options_.mapping);
  create_landmarks_from_depth(map_, id, camera_.color, options_.mapping);
  triangulate_landmarks(map_, id, camera_.color, options_.mapping);
  cull_landmarks(map_, options_.mapping);
  places_.add(id, bow_of(*frame.features));
  timings_.add("mapping", watch.elapsed());

  log_.back().keyframe = id;
  last_keyframe_ = id;
  frames_since_keyframe_ = 0;
  map_changed_ = true;
  set_reference_keyframe(id);
  detect_loops(id);
  const Stopwatch copying;
  back_end_.submit(map_, log_, sensor_, id, frame.id);
  timings_.add("mapping", copying.elapsed());
  return id;
}

void Slam::detect_loops(KeyframeId id) {
  if (!options_.loop.enabled) return;
  const Stopwatch watch;
  auto candidates = find_loop_candidates(map_, places_, id, loop_history_, options_.loop);
  loop_history_ = std::move(candidates.history);
  back_end_.add_loop_candidates(make_loop_candidates(map_, id, candidates.keyframes, options_.local_map,
                                                     seed_of(map_.keyframe(id).frame)));
  timings_.add("loop", watch.elapsed());
}

}  // namespace kinloop
