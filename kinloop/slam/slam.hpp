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
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/loop/candidates.hpp"
#include "kinloop/place/vocabulary.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"
#include "kinloop/slam/back_end.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/options.hpp"
#include "kinloop/slam/timings.hpp"
#include "kinloop/tracking/motion_model.hpp"

namespace kinloop {

class Slam {
 public:
  /// With the default vocabulary.
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

  [[nodiscard]] const Timings& timings() const { return timings_; }

  /// What was found of the sensor so far.
  [[nodiscard]] const SensorEstimate& sensor() const { return sensor_; }

  /// Per keyframe, how certain the final adjustment is of its pose (see FinalBundleAdjustment); empty before
  /// it.
  [[nodiscard]] const std::vector<Matrix6d>& keyframe_covariance() const { return keyframe_covariance_; }

  /// `listener` must outlive this object.
  void add_listener(Listener& listener) { listeners_.push_back(&listener); }

 private:
  void apply_results(const AppliedResults& work);
  TrackResult initialize_map(const PreparedFrame& frame);
  [[nodiscard]] bool repeats_previous_image(const PreparedFrame& frame) const;
  [[nodiscard]] TrackResult previous_result() const;
  TrackResult track_or_relocalize(const PreparedFrame& frame, bool& relocalized);
  [[nodiscard]] BowVector bow_of(const Features& features) const;
  void finish_localization();
  [[nodiscard]] bool is_localized(const TrackResult& result, const PreparedFrame& frame) const;
  [[nodiscard]] std::optional<TrackResult> relocalize(const PreparedFrame& frame) const;
  [[nodiscard]] PreparedFrame motion_compensated(const PreparedFrame& frame) const;
  void apply_sensor_estimate(const SensorEstimate& sensor);
  [[nodiscard]] bool previous_frame_lost() const {
    return !session_log().empty() && session_log().back().status == TrackStatus::kLost;
  }
  [[nodiscard]] bool should_start_component() const;
  void update_motion_model(const PreparedFrame& frame, const TrackResult& result);
  void store_previous_frame(const PreparedFrame& frame, const TrackResult& result);
  [[nodiscard]] bool should_insert_keyframe(const PreparedFrame& frame, const TrackResult& result) const;
  KeyframeId add_keyframe(const PreparedFrame& frame, const TrackResult& result);
  KeyframeId insert_keyframe(const PreparedFrame& frame, const TrackResult& result);
  void detect_loops(KeyframeId keyframe);
  void set_reference_keyframe(KeyframeId reference);
  void notify_listeners(const FrameResult& result, const PreparedFrame& frame);
  [[nodiscard]] KeyframeId next_keyframe_id() const {
    return KeyframeId{static_cast<uint32_t>(map_.keyframes().size())};
  }
  [[nodiscard]] uint64_t seed_of(FrameId frame) const;

  RgbdCamera camera_;
  SlamOptions options_;
  Vocabulary vocabulary_;
  Map map_;
  PlaceIndex places_;
  CandidateHistory loop_history_;
  BackEnd back_end_;
  bool map_changed_ = false;  // since the listeners were told

  LocalMap local_map_;
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
  Timings timings_;
  std::vector<Listener*> listeners_;
};

}  // namespace kinloop
