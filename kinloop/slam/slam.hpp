#pragma once
// The order of things. In: frames. Out: the pose of each, a map, and at the end the whole trajectory.
//
//   TumSource source(folder);
//   Slam slam(source.camera());
//   while (auto frame = source.next()) slam.process(*frame);
//   write_tum_trajectory("trajectory.txt", slam.finish());

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/base/progress.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/loop/candidates.hpp"
#include "kinloop/output/map_file.hpp"
#include "kinloop/place/vocabulary.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/map_work.hpp"
#include "kinloop/slam/options.hpp"
#include "kinloop/slam/room_times.hpp"
#include "kinloop/tracking/motion_model.hpp"

namespace kinloop {

class Slam {
 public:
  /// With the default dictionary.
  explicit Slam(const RgbdCamera& camera, const SlamOptions& options = {});
  Slam(const RgbdCamera& camera, const SlamOptions& options, Vocabulary vocabulary);
  ~Slam();
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  /// Takes in a map that was saved, before the first frame: this run goes on with it. A second one becomes
  /// components of their own, joined where a place is recognised. Gives what was
  /// added to the ids of its frames.
  uint32_t add_map(SavedMap saved);

  /// All of the map that a file holds, but what only the caller knows: program, options, images. `input` is
  /// what the frames of this run came from.
  [[nodiscard]] SavedMap saved_map(const std::string& input) const;

  /// What can be computed from a frame alone. Touches nothing of this object: it may run ahead on another
  /// thread.
  [[nodiscard]] PreparedFrame prepare(const RgbdFrame& frame) const;

  /// Takes the frames in order of time.
  FrameResult process(const PreparedFrame& measured);
  FrameResult process(const RgbdFrame& frame) { return process(prepare(frame)); }

  /// Ends the run: waits for work in flight, adjusts the whole map, refines every frame. Gives all tracked
  /// poses.
  Trajectory finish(const Progress& progress = {});

  /// The poses of this run known so far, without ending anything.
  [[nodiscard]] Trajectory trajectory() const { return trajectory_of(session_log(), map_); }

  [[nodiscard]] const Map& map() const { return map_; }
  [[nodiscard]] const FrameLog& log() const { return log_; }

  /// The frames of this run; in `log()` those of loaded maps stand before them.
  [[nodiscard]] std::span<const LoggedFrame> session_log() const {
    return std::span(log_).subspan(session_begin_);
  }

  /// The component of the map in which most of them were tracked.
  [[nodiscard]] uint32_t component() const { return main_component(session_log(), map_); }

  [[nodiscard]] const RoomTimes& times() const { return times_; }

  /// What was found of the sensor so far.
  [[nodiscard]] const SensorEstimate& sensor() const { return sensor_; }

  /// Per keyframe, how certain the final adjustment is of its pose (see FinalAdjustment); empty before it.
  [[nodiscard]] const std::vector<Matrix6d>& keyframe_covariance() const { return keyframe_covariance_; }

  /// `listener` must outlive this object.
  void listen(Listener& listener) { listeners_.push_back(&listener); }

 private:
  void take_in(const AppliedWork& work);
  TrackResult start(const PreparedFrame& frame);
  [[nodiscard]] bool repeats_previous(const PreparedFrame& frame) const;
  [[nodiscard]] TrackResult previous_result() const;
  TrackResult locate(const PreparedFrame& frame, bool& relocalized);
  [[nodiscard]] BowVector bow_of(const Features& features) const;
  void finish_localizing();
  [[nodiscard]] bool on_map(const TrackResult& result, const PreparedFrame& frame) const;
  [[nodiscard]] std::optional<TrackResult> look_up(const PreparedFrame& frame) const;
  [[nodiscard]] PreparedFrame at_rest(const PreparedFrame& frame) const;
  void take_sensor(const SensorEstimate& sensor);
  [[nodiscard]] bool after_loss() const {
    return !session_log().empty() && session_log().back().status == TrackStatus::kLost;
  }
  [[nodiscard]] bool lost_for_long() const;
  void learn_motion(const PreparedFrame& frame, const TrackResult& result);
  void remember(const PreparedFrame& frame, const TrackResult& result);
  [[nodiscard]] bool wants_keyframe(const PreparedFrame& frame, const TrackResult& result) const;
  KeyframeId add_keyframe(const PreparedFrame& frame, const TrackResult& result);
  KeyframeId insert_keyframe(const PreparedFrame& frame, const TrackResult& result);
  void look_for_loops(KeyframeId keyframe);
  void look_from(KeyframeId reference);
  void tell(const FrameResult& result, const PreparedFrame& frame);
  [[nodiscard]] KeyframeId next_keyframe() const {
    return KeyframeId{static_cast<uint32_t>(map_.keyframes().size())};
  }
  [[nodiscard]] uint64_t seed_of(FrameId frame) const;

  RgbdCamera camera_;
  SlamOptions options_;
  Vocabulary vocabulary_;
  Map map_;
  PlaceIndex places_;
  CandidateHistory loop_history_;
  MapWork work_;
  bool map_changed_ = false;  // since the listeners were told

  LocalView view_;
  std::optional<TrackedFrame> previous_;  // the last that was located; none before the start
  MotionModel motion_;
  KeyframeId last_keyframe_;
  int frames_since_keyframe_ = 0;

  FrameLog log_;
  size_t session_begin_ = 0;            // of this run in the log
  std::vector<SavedSession> sessions_;  // of the maps that were loaded
  uint32_t first_frame_ = 0;            // added to the ids of this run's frames
  SensorEstimate sensor_;
  std::vector<Matrix6d> keyframe_covariance_;
  RoomTimes times_;
  std::vector<Listener*> listeners_;
};

}  // namespace kinloop
