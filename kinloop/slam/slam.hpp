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
#include "kinloop/place/vocabulary.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"
#include "kinloop/slam/back_end/back_end.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/front_end.hpp"
#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/mapper.hpp"
#include "kinloop/slam/options.hpp"
#include "kinloop/slam/place_recognition.hpp"
#include "kinloop/slam/timings.hpp"
#include "kinloop/slam/tracker.hpp"

namespace kinloop {

/// What maps of earlier sessions brought into this one.
struct EarlierSessions {
  std::vector<SavedSession> sessions;
  size_t frame_count = 0;  ///< their frames are the first of the log
};

class Slam {
 public:
  /// With the default vocabulary. Throws UsageError where an option has a value that is not allowed.
  explicit Slam(const RgbdCamera& camera, const SlamOptions& options = {});
  Slam(const RgbdCamera& camera, const SlamOptions& options, Vocabulary vocabulary);
  ~Slam() = default;
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  /// Takes in a map that was saved, before the first frame: this run goes on with it. A second one becomes
  /// components of their own, joined where a place is recognised. Gives what was
  /// added to the ids of its frames.
  uint32_t add_map(SavedMap saved);

  /// All of the map that a file holds, but what only the caller knows: program, options, images. `input` is
  /// what the frames of this run came from.
  [[nodiscard]] SavedMap saved_map(const std::string& input) const;

  /// What prepares frames for `process`. It may run ahead on another thread (FramePipeline); maps must be
  /// added before.
  [[nodiscard]] const FrontEnd& front_end() const { return front_end_; }
  [[nodiscard]] PreparedFrame prepare(const RgbdFrame& frame) const { return front_end_.prepare(frame); }

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
    return std::span(log_).subspan(earlier_.frame_count);
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
  void apply_results(const AppliedResults& results);
  void apply_sensor_estimate(const SensorEstimate& sensor);
  KeyframeId insert_keyframe(const FrameTracking& tracking);
  void find_loops(KeyframeId keyframe);
  void finish_localization();
  void notify_listeners(const FrameResult& result, const PreparedFrame& frame);
  [[nodiscard]] JobContext job_context(KeyframeId new_keyframe = {}) const {
    return {map_, log_, sensor_.value, new_keyframe};
  }

  RgbdCamera camera_;
  SlamOptions options_;
  Map map_;
  FrontEnd front_end_;
  Tracker tracker_;
  Mapper mapper_;
  PlaceRecognition places_;
  BackEnd back_end_;

  FrameLog log_;
  EarlierSessions earlier_;
  SensorEstimate sensor_;
  std::vector<Matrix6d> keyframe_covariance_;
  Timings timings_;
  std::vector<Listener*> listeners_;
  bool map_changed_ = false;  // since the listeners were told
};

}  // namespace kinloop
