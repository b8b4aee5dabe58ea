// Slam with maps of earlier runs: continuing them, localization in them, saving.

#include <algorithm>

#include "kinloop/back_end/final/refine_frames.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"
#include "kinloop/slam/saved_session.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {
namespace {

/// The id after those of all frames, at least `first`. A damaged file may have keyframes but no frames.
uint32_t next_frame(const FrameLog& log, const std::vector<Keyframe>& keyframes, uint32_t first) {
  uint32_t next = first;
  for (const LoggedFrame& entry : log) next = std::max(next, entry.id.value + 1);
  for (const Keyframe& keyframe : keyframes) next = std::max(next, keyframe.frame.value + 1);
  return next;
}

}  // namespace

uint32_t Slam::add_map(SavedMap saved) {
  require(session_log().empty(), "add_map: must be called before the first frame");
  const bool first = map_.keyframes().empty();
  const auto begin = static_cast<uint32_t>(map_.keyframes().size());
  const uint32_t shift = front_end_.first_frame();
  const FrameLog log = logged_frames(saved, begin, shift);
  for (Keyframe& keyframe : saved.map.keyframes) keyframe.frame.value += shift;
  for (const SavedSession& session : saved.sessions) {
    earlier_.sessions.push_back({session.input, FrameId{session.first_frame.value + shift}});
  }
  log_.insert(log_.end(), log.begin(), log.end());
  earlier_.frame_count = log_.size();
  front_end_ = FrontEnd(sensor(), options_.features, next_frame(log, saved.map.keyframes, shift));
  for (LoopClosure& loop : saved.map.loop_closures) loop.reason = LoopReason::kLoaded;
  if (first) sensor_estimate_ = kinloop::sensor_estimate(saved.sensor, make_sensor(camera_, options_.noise));
  map_.append(std::move(saved.map));
  const auto end = static_cast<uint32_t>(map_.keyframes().size());
  if (end == 0) return shift;
  for (uint32_t id = begin; id < end; ++id) places_.add(map_.keyframe(KeyframeId{id}));
  keyframe_memory_.apply_limit(map_);
  if (!first && !options_.localize_only) join_components(begin);
  return shift;
}

/// Looks for the places of the keyframes from `first` on in those before, and if that does not join
/// them, for the places of those before in the new ones, and for support of what was found: where one
/// recording ends, the next may begin.
void Slam::join_components(uint32_t first) {
  const auto count = static_cast<uint32_t>(map_.keyframes().size());
  const auto search = [this](uint32_t begin, uint32_t end) {
    for (uint32_t id = begin; id < end; ++id) {
      find_loops(KeyframeId{id});
      apply_results(back_end_.apply_remaining(job_context()));
    }
  };
  search(first, count);
  const auto is_between = [&](const LoopClosure& loop) {
    return std::min(loop.a.value, loop.b.value) < first && std::max(loop.a.value, loop.b.value) >= first;
  };
  const auto are_joined = [&] {
    return std::any_of(map_.loop_closures().begin(), map_.loop_closures().end(), is_between);
  };
  if (!are_joined()) search(0, first);
  if (!are_joined()) {
    const std::vector<LoopClosure> waiting = map_.other_loops();
    for (const LoopClosure& loop : waiting) {
      if (loop.stage != LoopStage::kProvisional || !is_between(loop)) continue;
      for (LoopVerificationProblem& problem : seek_support(map_, loop, options_.local_map))
        back_end_.add(std::move(problem));
    }
    apply_results(back_end_.apply_remaining(job_context()));
  }
  apply_results(back_end_.apply_last(job_context()));
}

SavedMap Slam::saved_map(const std::string& input) const {
  SavedMap saved;
  saved.sessions = earlier_.sessions;
  if (!session_log().empty()) saved.sessions.push_back({input, FrameId{front_end_.first_frame()}});
  saved.camera = camera_;
  saved.sensor = saved_sensor(sensor_estimate_);
  saved.map = map_.data();
  // The map has been adjusted: its relative poses are better than the first measurements.
  for (LoopClosure& loop : saved.map.loop_closures) {
    loop.T_a_b = map_.relative_pose(loop.a, loop.b);
    loop.corrected = true;
  }
  saved.frames.assign(log_.begin(), log_.end());  // without what only the run needs
  return saved;
}

/// Refines the frames tracked on the map; the poses of the others are unknown.
void Slam::finish_localization() {
  log_ = refine_frames(std::move(log_), frame_refinement(), FrameSelection::kAll, options_.global_ba.threads);
  for (size_t i = earlier_.frame_count; i < log_.size(); ++i) {
    if (log_[i].measurements.empty() && !log_[i].refined) log_[i].outcome = TrackingOutcome::kLost;
  }
}

}  // namespace kinloop
