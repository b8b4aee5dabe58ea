#pragma once
// The SLAM system: processes frames in order and returns the pose of each, the map and the final trajectory.
//
//   TumSource source(folder);
//   Slam slam(source.camera());
//   while (auto frame = source.next()) slam.process(*frame);
//   write_tum_trajectory("trajectory.txt", slam.finish());

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/back_end/back_end.hpp"
#include "kinloop/back_end/final/refine_frames.hpp"
#include "kinloop/belief/online_covariance.hpp"
#include "kinloop/core/progress.hpp"
#include "kinloop/core/timings.hpp"
#include "kinloop/loop/recognition/place_recognition.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/frames/odometry_frame.hpp"
#include "kinloop/map/keyframe_memory.hpp"
#include "kinloop/map/saved_map.hpp"
#include "kinloop/mapping/mapper.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/options.hpp"
#include "kinloop/tracking/evidence/camera_fixed_region.hpp"
#include "kinloop/tracking/evidence/depth_continuity.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// Data of loaded maps.
struct EarlierSessions {
  std::vector<SavedSession> sessions;
  size_t frame_count = 0;  ///< number of loaded frames; they come first in the log
};

/// A place where the camera was located without the frame before, by the look of an image or after a gap, and
/// what the frames since then say of it.
struct RelocalizationTrial {
  size_t begin = 0;  ///< of these frames in the log
  int64_t begin_ns = 0;
  KeyframeId end;  ///< the first keyframe made since then
  uint32_t component = 0;
  LocationCheck check = {};
  int64_t looked_ns = 0;  ///< when the look of a frame was added last
};

/// A place that was contradicted.
struct RelocalizationCooldown {
  uint32_t component = 0;
  int64_t contradicted_ns = 0;
};

/// Where the camera is said to be.
struct CameraPlace {
  std::optional<uint32_t> visit;  ///< none before the first pose
  std::optional<RelocalizationTrial> trial;
  std::optional<RelocalizationCooldown> cooldown;
};

class Slam {
 public:
  /// Uses the default vocabulary. Throws UsageError if an option value is not allowed.
  explicit Slam(const RgbdCamera& camera, const SlamOptions& options = {});
  Slam(const RgbdCamera& camera, const SlamOptions& options, Vocabulary vocabulary);
  ~Slam() = default;
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  /// Adds a saved map, which this run continues. Call before the first frame. Further maps become separate
  /// components, joined when a place is recognized. Returns the offset added to the frame ids of the saved
  /// map.
  uint32_t add_map(SavedMap saved);

  /// Returns the map in the form of a map file, without program, options and images, which the caller adds.
  /// `input` names the source of this run.
  [[nodiscard]] SavedMap saved_map(const std::string& input) const;

  /// Returns the front end, which prepares frames for `process` ahead on another thread (FramePipeline). Add
  /// maps before the first call.
  [[nodiscard]] const FrontEnd& front_end() const { return front_end_; }

  /// Returns whether the next frame will probably be tracked by keypoints.
  [[nodiscard]] bool expects_keypoints() const { return tracker_.expects_keypoints(); }

  /// Tracks the next frame, prepared ahead or not, and maps it. Frames must be in order of time.
  TrackedFrame process(const Frame& frame) {
    track(frame);
    return update_map();
  }

  /// The first part of `process`: returns the pose as soon as it is known. Maps the frame before if that has
  /// not been done.
  TrackedFrame track(const Frame& frame);

  /// The second part, which takes longest if the frame becomes a keyframe: adds the frame of the last `track`
  /// to the log and to the map, and shows it to the listeners. Returns it: a keyframe has been tracked once
  /// more, by all of its keypoints.
  TrackedFrame update_map();

  /// Returns whether a frame has been tracked that is not in the map yet.
  [[nodiscard]] bool has_unmapped_frame() const { return unmapped_.has_value(); }

  /// Returns the frame of the last `track`, as it is known now; null before the first.
  [[nodiscard]] const EstimatedFrame* latest() const {
    if (unmapped_) return &*unmapped_;
    return session_log().empty() ? nullptr : &log_.back();
  }

  /// Returns where the frame of the odometry is in the map, see TrackedFrame::T_map_odom.
  [[nodiscard]] const SE3& T_map_odom() const { return odometry_.T_map_odom(); }

  /// Ends the run: waits for background jobs, adjusts the whole map, refines every frame and bridges those
  /// that stay lost between good ones. Returns `trajectory()`.
  Trajectory finish(const Progress& progress = {});

  /// Returns the current poses of this run without ending it; doubtful ones only if asked for.
  [[nodiscard]] Trajectory trajectory(DoubtfulPoses doubtful = DoubtfulPoses::kLeftOut) const {
    return trajectory_of(session_log(), map_, doubtful);
  }

  [[nodiscard]] const Map& map() const { return map_; }
  [[nodiscard]] const FrameLog& log() const { return log_; }

  /// Returns the frames of this run; in `log()` the frames of loaded maps come first.
  [[nodiscard]] std::span<const LoggedFrame> session_log() const {
    return std::span(log_).subspan(earlier_.frame_count);
  }

  /// Returns the map component in which most frames of this run were tracked.
  [[nodiscard]] uint32_t component() const { return main_component(session_log(), map_); }

  /// Returns the mask of what moves with the camera at the latest frame, 8UC1 of the image's size, 0 = moves
  /// with it; empty if nothing does.
  [[nodiscard]] cv::Mat camera_mask() const;

  [[nodiscard]] const Timings& timings() const { return timings_; }

  /// Returns the options in use.
  [[nodiscard]] const SlamOptions& options() const { return options_; }

  /// Returns the sensor in use: the camera, its noise and the corrections estimated so far.
  [[nodiscard]] const Sensor& sensor() const { return sensor_estimate_.sensor; }

  /// Returns the same with the standard deviations of the corrections.
  [[nodiscard]] const SensorEstimate& sensor_estimate() const { return sensor_estimate_; }

  /// Returns the pose covariance of each keyframe from the final adjustment (see FinalBundleAdjustment);
  /// empty before it.
  [[nodiscard]] const std::vector<Matrix6d>& keyframe_covariance() const { return keyframe_covariance_; }

  /// `listener` must outlive this object.
  void add_listener(Listener& listener) { listeners_.push_back(&listener); }

 private:
  [[nodiscard]] Frame with_steady_depth(const Frame& frame);
  [[nodiscard]] Frame without_fixed_region(const Frame& frame);
  void add_input_evidence(TrackedFrame& tracked) const;
  bool compensate_first(const TrackedFrame& second);
  void withdraw_fixed_region();
  [[nodiscard]] std::optional<size_t> contradicted_since() const;
  void withdraw_contradicted();
  [[nodiscard]] std::optional<TrackedFrame> relocalize(const Frame& frame) const;
  [[nodiscard]] bool is_located_anew(const TrackedFrame& tracked) const;
  void check_location(TrackedFrame& tracked);
  void examine(const TrackedFrame& tracked, RelocalizationTrial& place) const;
  void take_back_location(TrackedFrame& tracked);
  void trust_place_since(int64_t since_ns, uint32_t component);
  void doubt_repeats();
  [[nodiscard]] bool has_doubts_since(int64_t since_ns) const;
  void doubt_frames_since(int64_t since_ns, DoubtCause cause);
  void apply_due_results(FrameId now);
  void apply_results(const AppliedResults& results);
  void rebase_after_split(const std::vector<SE3>& T_world_keyframe_before);
  void apply_sensor_estimate(const AppliedSensor& applied);
  [[nodiscard]] TrackedFrame with_keyframe(TrackedFrame tracked);
  void state_place(TrackedFrame& tracked) const;
  [[nodiscard]] std::optional<TrackedFrame> select_keyframe(const TrackedFrame& tracked);
  void insert_keyframe(TrackedFrame& tracked);
  void find_loops(KeyframeId keyframe);
  void join_components(uint32_t first);
  void submit_jobs(FrameId now, KeyframeId new_keyframe);
  void finish_localization();
  void add_to_log(const TrackedFrame& tracked);
  void state_covariances();
  TrackedFrame publish(TrackedFrame tracked);
  [[nodiscard]] JobContext job_context(KeyframeId new_keyframe = {}) const {
    return {map_, log_, sensor(), new_keyframe};
  }

  [[nodiscard]] FrameRefinement frame_refinement() const { return {map_, sensor(), options_.tracking.pose}; }

  RgbdCamera camera_;
  SlamOptions options_;
  SensorEstimate sensor_estimate_;
  Map map_;
  KeyframeMemory keyframe_memory_;
  Timings timings_;
  FrontEnd front_end_;
  DepthContinuity depth_;
  CameraFixedRegion fixed_region_;
  Tracker tracker_;
  KeyframeSelector keyframes_;
  Relocalizer relocalizer_;
  Mapper mapper_;
  PlaceRecognition places_;
  BackEnd back_end_;

  FrameLog log_;
  LogLimiter log_limiter_;
  EarlierSessions earlier_;
  OdometryFrame odometry_;
  OnlineCovariance online_covariance_;
  std::vector<Matrix6d> keyframe_covariance_;
  std::vector<Listener*> listeners_;
  CameraPlace place_;
  std::optional<TrackedFrame> unmapped_;  // the latest frame, until `update_map`
  bool map_changed_ = false;              // since the last notification of the listeners
};

}  // namespace kinloop
