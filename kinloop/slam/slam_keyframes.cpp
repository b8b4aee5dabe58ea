// Slam's keyframes: which frames become one, and what that adds to the map.

#include "kinloop/mapping/grow.hpp"
#include "kinloop/mapping/triangulate.hpp"
#include "kinloop/slam/slam.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"

namespace kinloop {

bool Slam::wants_keyframe(const PreparedFrame& frame, const TrackResult& result) const {
  if (result.status == TrackStatus::kLost) return false;
  if (result.reference == next_keyframe()) return true;
  const KeyframeQuestion question{result, frame, motions_from_keyframes(map_, result, last_keyframe_),
                                  frames_since_keyframe_, confirmed_landmarks(map_, view_.reference)};
  return needs_keyframe(question, options_.tracking.keyframe);
}

/// The world begins at the first camera; a new component is put, for want of better, where the camera was
/// last.
KeyframeId Slam::add_keyframe(const PreparedFrame& frame, const TrackResult& result) {
  if (result.reference != next_keyframe()) {
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
  observe_matches(map_, id, result.matches);
  attach_landmarks(map_, id, make_local_view(map_, id, options_.view), camera_.color, options_.mapping);
  grow_from_depth(map_, id, camera_.color, options_.mapping);
  grow_from_parallax(map_, id, camera_.color, options_.mapping);
  cull_landmarks(map_, options_.mapping);
  places_.add(id, bow_of(*frame.features));
  times_.add("mapping", watch.spent());

  log_.back().keyframe = id;
  last_keyframe_ = id;
  frames_since_keyframe_ = 0;
  map_changed_ = true;
  look_from(id);
  look_for_loops(id);
  const Stopwatch copying;
  work_.submit(map_, log_, sensor_, id, frame.id);
  times_.add("mapping", copying.spent());
  return id;
}

void Slam::look_for_loops(KeyframeId id) {
  if (!options_.loop.enabled) return;
  const Stopwatch watch;
  auto candidates = find_loop_candidates(map_, places_, id, loop_history_, options_.loop);
  loop_history_ = std::move(candidates.history);
  work_.note_possible_loop(
      loop_question(map_, id, candidates.keyframes, options_.view, seed_of(map_.keyframe(id).frame)));
  times_.add("loop", watch.spent());
}

}  // namespace kinloop
