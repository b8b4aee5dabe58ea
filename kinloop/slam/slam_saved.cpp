// What Slam does with maps of earlier runs: goes on with them, localises in them, gives them to be saved.

#include "kinloop/base/errors.hpp"
#include "kinloop/slam/final_bundle_adjustment.hpp"
#include "kinloop/slam/saved_session.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {

uint32_t Slam::add_map(SavedMap saved) {
  require(session_log().empty(), "add_map: must be called before the first frame");
  const bool first = map_.keyframes().empty();
  const KeyframeId begin = next_keyframe_id();
  const uint32_t shift = first_frame_;
  const FrameLog log = logged_frames(saved, begin.value, shift);
  for (const SavedSession& session : saved.sessions) {
    sessions_.push_back({session.input, FrameId{session.first_frame.value + shift}});
  }
  log_.insert(log_.end(), log.begin(), log.end());
  session_begin_ = log_.size();
  first_frame_ = log_.empty() ? 0 : log_.back().frame.value + 1;
  if (first) sensor_ = sensor_estimate(saved.sensor, nominal_sensor(camera_));
  map_.append(std::move(saved.map));
  if (map_.keyframes().empty()) return shift;
  last_keyframe_ = map_.keyframes().back().id;
  for (KeyframeId id = begin; id < next_keyframe_id(); ++id.value) {
    places_.add(id, bow_of(*map_.keyframe(id).features));
  }
  for (KeyframeId id = begin; !first && id < next_keyframe_id(); ++id.value) {
    detect_loops(id);
    apply_results(back_end_.apply_remaining(map_));
  }
  loop_history_.clear();
  return shift;
}

SavedMap Slam::saved_map(const std::string& input) const {
  SavedMap saved;
  saved.sessions = sessions_;
  if (!session_log().empty()) saved.sessions.push_back({input, FrameId{first_frame_}});
  saved.camera = camera_;
  saved.sensor = saved_sensor(sensor_);
  saved.map = map_.data();
  saved.frames = saved_frames(log_);
  return saved;
}

/// Whether the frame shows enough of the map to say where it is, without the frames before it.
bool Slam::is_localized(const TrackResult& result, const PreparedFrame& frame) const {
  return result.stats.inliers >= options_.tracking.min_inliers &&
         has_sufficient_inlier_ratio(result, *frame.features, options_.tracking.min_inlier_ratio);
}

/// Refines the frames that rest on the map; of the others it is not known where they are.
void Slam::finish_localization() {
  log_ = refine_frames(std::move(log_), map_, camera_.color, sensor_.value, options_.tracking.pose,
                       FrameSelection::kAll, options_.global_ba.threads);
  for (size_t i = session_begin_; i < log_.size(); ++i) {
    if (log_[i].observations.empty()) log_[i].status = TrackStatus::kLost;
  }
}

}  // namespace kinloop
