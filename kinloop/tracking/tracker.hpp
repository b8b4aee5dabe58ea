#pragma once
// Tracks prepared frames against the previous frame and the map.

#include <functional>
#include <optional>
#include <variant>

#include "kinloop/core/timings.hpp"
#include "kinloop/tracking/direct_tracking.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "kinloop/tracking/local_map_tracking.hpp"
#include "kinloop/tracking/motion_model.hpp"

namespace kinloop {

/// Located relative to the previous frame and the local map.
struct Tracked {
  TrackResult result;
};

/// Located by place recognition.
struct Relocalized {
  TrackResult result;
};

/// Not located while there is nothing to track against: the frame starts a map, or a new component of it.
struct NewMap {};

/// Not located. `stats` report how far tracking got.
struct Lost {
  TrackStats stats;
};

using TrackOutcome = std::variant<Tracked, Relocalized, NewMap, Lost>;

/// Returns the located pose of the outcome, or null.
const TrackResult* located(const TrackOutcome& outcome);

/// Tracking result of one frame.
struct FrameTracking {
  TrackOutcome outcome;
  PreparedFrame frame;  ///< motion-compensated
  MotionModel motion;   ///< includes the motion of this frame
  bool repeat = false;  ///< repeats the previous image: takes its pose and does not update the motion model
  bool direct = false;  ///< located by patches of the local map
  bool has_keypoints = true;  ///< false: `frame.features` are landmarks found without keypoint detection
};

/// What the tracker uses.
struct TrackerOptions {
  FeatureOptions features;
  TrackingOptions tracking;
  LocalMapOptions local_map;
  int min_initial_keypoints = 60;
  int lost_frames_before_new_component = 5;
  bool localize_only = false;
  uint64_t seed = 1;
};

/// Locates a frame in the map by its appearance; nullopt if it is not recognized.
using Relocalizer = std::function<std::optional<TrackResult>(const PreparedFrame&)>;

/// What the tracker needs from the rest of the system.
struct TrackingContext {
  const Map& map;
  const Sensor& sensor;
  const Relocalizer& relocalize;
};

/// Keeps the previous frame, the local map and the motion model. `track` is const; only `update` changes the
/// state.
class Tracker {
 public:
  Tracker(const Sensor& sensor, const TrackerOptions& options)
      : options_(options), front_end_(sensor, options.features) {}

  /// Locates `measured` from the current state. Adds the elapsed times to `timings`.
  [[nodiscard]] FrameTracking track(const PreparedFrame& measured, const TrackingContext& context,
                                    Timings& timings) const;

  /// Returns `tracked`, which was tracked directly, with all keypoints of its frame, matched with the local
  /// map. An outcome other than Tracked means that too few match.
  [[nodiscard]] FrameTracking with_keypoints(const FrameTracking& tracked, const TrackingContext& context,
                                             Timings& timings) const;

  /// Updates the state after a frame or a change of the map: the latest frame, if any, and the local map of
  /// `reference` in the current map. Call after each frame and after each change of the map.
  void update(const Map& map, KeyframeId reference, const FrameTracking* latest = nullptr);

  /// Returns whether the next frame will probably be tracked by keypoints, as the previous one was.
  [[nodiscard]] bool expects_keypoints() const { return previous_has_keypoints_ || lost_frames_ > 0; }

  /// Returns the reference keyframe of the local map; invalid before the first.
  [[nodiscard]] KeyframeId reference() const { return local_map_.reference; }

 private:
  [[nodiscard]] bool repeats_previous_image(const PreparedFrame& frame) const;
  [[nodiscard]] TrackResult previous_result() const;
  [[nodiscard]] FrameTracking repeat_previous(const PreparedFrame& measured) const;
  [[nodiscard]] PredictedPose predict(int64_t stamp_ns) const;
  [[nodiscard]] std::optional<DirectlyTracked> track_directly(const PreparedFrame& measured,
                                                              const Sensor& sensor) const;
  [[nodiscard]] FrameTracking track_by_keypoints(PreparedFrame measured, const TrackingContext& context,
                                                 Timings& timings) const;
  [[nodiscard]] FrameTracking complete(TrackOutcome outcome, const PreparedFrame& measured,
                                       const Sensor& sensor, Timings& timings) const;
  [[nodiscard]] TrackedFrame previous_with_keypoints(const Sensor& sensor, Timings& timings) const;
  TrackResult track_all_keypoints(PreparedFrame& frame, const SE3& T_reference_camera, const Sensor& sensor,
                                  const MotionModel& motion, Timings& timings) const;
  [[nodiscard]] TrackResult track_previous(const PreparedFrame& frame, const TrackedFrame& previous,
                                           const Sensor& sensor) const;
  [[nodiscard]] TrackOutcome locate(const PreparedFrame& frame, const TrackingContext& context,
                                    Timings& timings) const;
  [[nodiscard]] TrackOutcome start_map_or_lose(const PreparedFrame& frame) const;
  [[nodiscard]] MotionModel motion_after(const PreparedFrame& frame, const TrackOutcome& outcome) const;
  [[nodiscard]] PreparedFrame deskewed(const PreparedFrame& measured, const Sensor& sensor,
                                       const MotionModel& motion) const;
  void remember(const FrameTracking& latest);

  TrackerOptions options_;
  FrontEnd front_end_;
  std::optional<TrackedFrame> previous_;  // the last located frame; none before the first
  bool previous_has_keypoints_ = true;    // false: it has no descriptors
  LocalMap local_map_;
  MotionModel motion_;
  int lost_frames_ = 0;  // since `previous_`
};

}  // namespace kinloop
