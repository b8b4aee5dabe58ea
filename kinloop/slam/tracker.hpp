#pragma once
// In: prepared frames and the map. Out: where the camera was in each.

#include <optional>
#include <variant>

#include "kinloop/slam/options.hpp"
#include "kinloop/slam/place_recognition.hpp"
#include "kinloop/slam/timings.hpp"
#include "kinloop/tracking/motion_model.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// Located against the frame before and the local map.
struct Tracked {
  TrackResult result;
};

/// Located by place recognition.
struct Relocalized {
  TrackResult result;
};

/// Where nothing is known: the frame begins a map, or a new component of it.
struct NewMap {};

/// Not located. `stats` tell how far tracking came.
struct Lost {
  TrackStats stats;
};

using TrackOutcome = std::variant<Tracked, Relocalized, NewMap, Lost>;

/// Where the outcome puts the camera; null where it does not.
const TrackResult* located(const TrackOutcome& outcome);

/// What tracking makes of one frame.
struct FrameTracking {
  TrackOutcome outcome;
  PreparedFrame frame;  ///< deskewed by its own motion
  MotionModel motion;   ///< with the motion of this frame
  bool repeat = false;  ///< the image of the frame before, once more: its pose, and nothing learnt
};

/// What the tracker asks of the rest of the run.
struct TrackingContext {
  const Map& map;
  const PlaceRecognition& places;
  const SensorVector& sensor;
};

/// Remembers the previous frame, the local map and the motion of the camera. `track` changes nothing;
/// `update` is the one function that does.
class Tracker {
 public:
  Tracker(const PinholeCamera& camera, const SlamOptions& options) : camera_(camera), options_(options) {}

  /// Locates `measured` from what is remembered. Its times are added to `timings`.
  [[nodiscard]] FrameTracking track(const PreparedFrame& measured, const TrackingContext& context,
                                    Timings& timings) const;

  /// Takes in what has happened: the latest frame, if there is one, and the map as it stands now, whose local
  /// map is then that of `reference`. To be called after each frame and each change of the map.
  void update(const Map& map, KeyframeId reference, const FrameTracking* latest = nullptr);

  /// The keyframe of the local map, which poses are relative to; invalid before the first.
  [[nodiscard]] KeyframeId reference() const { return local_map_.reference; }

 private:
  [[nodiscard]] bool repeats_previous_image(const PreparedFrame& frame) const;
  [[nodiscard]] TrackResult previous_result() const;
  [[nodiscard]] TrackResult track_previous(const PreparedFrame& frame) const;
  [[nodiscard]] TrackOutcome locate(const PreparedFrame& frame, const TrackingContext& context,
                                    Timings& timings) const;
  [[nodiscard]] TrackOutcome start_map_or_lose(const PreparedFrame& frame) const;
  [[nodiscard]] MotionModel motion_after(const PreparedFrame& frame, const TrackOutcome& outcome) const;
  [[nodiscard]] PreparedFrame deskewed(const PreparedFrame& measured, const SensorVector& sensor,
                                       const MotionModel& motion) const;
  void remember(const FrameTracking& latest);

  PinholeCamera camera_;
  SlamOptions options_;
  std::optional<TrackedFrame> previous_;  // the last that was located; none before the start
  LocalMap local_map_;
  MotionModel motion_;
  int lost_frames_ = 0;  // since then
};

}  // namespace kinloop
