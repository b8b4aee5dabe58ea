#pragma once
// Tracks frames against the previous frame and the map: directly, by patches of landmarks, or by keypoints
// where that fails, or by place recognition after a loss.

#include <deque>
#include <functional>
#include <optional>

#include "kinloop/belief/reach.hpp"
#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/core/timings.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// What the tracker uses.
struct TrackerOptions {
  FeatureOptions features;
  TrackingOptions tracking;
  LocalMapOptions local_map;
  int min_initial_keypoints = 60;
  int lost_frames_before_new_component = 5;
  double max_predicted_sigma_m = 0.1;
  bool localize_only = false;
  uint64_t seed = 1;
};

/// Locates a frame in the map by its appearance; nullopt if it is not recognized.
using Relocalizer = std::function<std::optional<TrackedFrame>(const Frame&)>;

/// What the tracker needs from the rest of the system.
struct TrackingContext {
  const Map& map;
  const Sensor& sensor;
  const Relocalizer& relocalize;
};

/// Keeps the previous frame, the local map and the motion model. `track` does not change them.
class Tracker {
 public:
  /// `front_end` and `timings`, to which the time of each stage is added, must outlive this object.
  Tracker(const FrontEnd& front_end, const TrackerOptions& options, Timings& timings)
      : options_(options), front_end_(front_end), timings_(timings) {}

  /// Tracks a prepared frame from the current state.
  [[nodiscard]] TrackedFrame track(const Frame& measured, const TrackingContext& context) const;

  /// Extracts all keypoints of a frame that was tracked by patches, and matches them with the local map from
  /// its pose. The result is lost if too few match.
  [[nodiscard]] TrackedFrame rematch_keypoints(const TrackedFrame& tracked, const Sensor& sensor) const;

  /// Adds to `moved` of a frame with all of its keypoints where these move: they shall not become landmarks.
  void find_moving(TrackedFrame& tracked, const Sensor& sensor) const;

  /// Makes `latest` the previous frame. If it became a keyframe, the local map is built around that, else
  /// around the keyframe that shares most landmarks with it.
  void update(const TrackedFrame& latest, const Map& map);

  /// Says that the motion up to the previous frame was wrong: its depth was an old one. The velocity is
  /// unknown until the frame after the next.
  void forget_motion();

  /// Tells the velocity of the previous frame, which has started a map, once it is known; `map` is
  /// compensated for it.
  void set_first_velocity(const Velocity& velocity, int64_t interval_ns, const Map& map);

  /// Rebuilds the local map around `reference`. Call after each change of the map.
  void update(const Map& map, KeyframeId reference);

  /// The same where the keyframe that the previous frame is relative to, `T_reference_old` from the new one,
  /// has become part of another component.
  void update(const Map& map, KeyframeId reference, const SE3& T_reference_old);

  /// Forgets the previous frame and the local map, since their poses have turned out to be wrong.
  void reset();

  /// Returns the previous frame with a pose; null before the first.
  [[nodiscard]] const TrackedFrame* previous() const { return previous_ ? &*previous_ : nullptr; }

  /// Whether the velocity of the previous frame is known, unlike that of one in which a place was recognized.
  [[nodiscard]] bool knows_velocity() const { return motion_.knows_velocity(); }

  /// Returns whether the next frame will probably be tracked by keypoints, as the previous one was.
  [[nodiscard]] bool expects_keypoints() const;

  /// Returns since when the poses have been in doubt, lost frames left out; nullopt if the latest is not.
  [[nodiscard]] std::optional<int64_t> doubtful_since_ns() const { return state_.doubtful_since_ns; }

  /// Forgets the last pose beyond doubt.
  void forget_trusted() { trusted_.reset(); }

  /// Returns the last pose beyond doubt; nullopt before the first.
  [[nodiscard]] const std::optional<CameraMotion>& trusted() const { return trusted_; }

  /// Returns the reference keyframe of the local map; invalid before the first.
  [[nodiscard]] KeyframeId reference() const { return local_map_.reference; }

 private:
  [[nodiscard]] bool is_in_long_doubt(const TrackedFrame& tracked) const;
  [[nodiscard]] std::optional<TrackedFrame> find_elsewhere(const TrackedFrame& tracked, Frame measured,
                                                           const TrackingContext& context) const;
  [[nodiscard]] std::optional<TrackedFrame> start_map_after_doubt(const TrackedFrame& tracked, Frame frame,
                                                                  const Sensor& sensor) const;
  [[nodiscard]] Frame with_features(Frame frame) const;
  [[nodiscard]] Frame without_moved(const Frame& frame) const;
  void find_moved(TrackedFrame& tracked, const Frame& frame) const;
  [[nodiscard]] bool repeats_previous_image(const Frame& frame) const;
  [[nodiscard]] TrackedFrame repeat_previous(Frame frame) const;
  [[nodiscard]] PredictedPose predict(int64_t stamp_ns) const;
  [[nodiscard]] PredictedView expected_view(int64_t stamp_ns) const;
  [[nodiscard]] std::optional<TrackedFrame> track_by_patches(const Frame& frame, const Sensor& sensor) const;
  [[nodiscard]] TrackedFrame track_by_keypoints(Frame frame, const TrackingContext& context) const;
  [[nodiscard]] TrackedFrame locate(const Frame& frame, const TrackingContext& context) const;
  [[nodiscard]] bool may_start_component() const;
  [[nodiscard]] bool may_be_elsewhere(const Frame& frame) const;
  [[nodiscard]] bool continues_previous(const Frame& frame) const;
  [[nodiscard]] bool is_reachable(const TrackedFrame& found, const Map& map) const;
  [[nodiscard]] bool jumps(const TrackedFrame& tracked, const Frame& frame) const;
  [[nodiscard]] bool is_hypothesis(const TrackedFrame& tracked) const;
  [[nodiscard]] bool is_contradicted(const TrackedFrame& tracked, const Frame& frame) const;
  [[nodiscard]] std::optional<TrackedFrame> track_from_previous(const Frame& frame,
                                                                const Sensor& sensor) const;
  [[nodiscard]] TrackedFrame start_map_or_lose(const Frame& frame) const;
  [[nodiscard]] TrackedFrame with_motion(TrackedFrame tracked, Frame measured, const Sensor& sensor) const;
  [[nodiscard]] Velocity velocity_of(const TrackedFrame& tracked) const;
  [[nodiscard]] TrackedFrame with_motion_prior(TrackedFrame tracked, const Features& measured,
                                               const Sensor& sensor) const;
  [[nodiscard]] Frame deskewed(Frame measured, const Sensor& sensor, const Velocity& velocity) const;
  [[nodiscard]] bool follows_doubtful_pose() const;
  [[nodiscard]] bool follows_weak_pose() const;
  [[nodiscard]] bool remains_weak(const TrackedFrame& tracked) const;
  [[nodiscard]] bool follows_previous(const TrackedFrame& tracked) const;
  void remember(const TrackedFrame& latest);
  void keep_recent(const TrackedFrame& latest);
  void express_previous_in(KeyframeId reference, const Map& map);

  /// What the frames until now say of the next one.
  struct State {
    int lost_frames = 0;              // in a row
    int64_t lost_since_ns = 0;        // if there are any
    std::optional<int64_t> moved_ns;  // when something moved last
    /// Since when the camera is thought to be where it was relocalized, without confirmation.
    std::optional<int64_t> hypothesis_since_ns;
    std::optional<int64_t> doubtful_since_ns;  // are the poses, but for lost frames
    bool depth_was_frozen = false;             // see `forget_motion`
    bool lacks_scale = false;                  // the previous pose, see `lacks_scale`
  };

  TrackerOptions options_;
  const FrontEnd& front_end_;
  Timings& timings_;
  std::optional<TrackedFrame> previous_;  // the last frame with a pose; none before the first
  std::optional<CameraMotion> trusted_;   // the last pose beyond doubt
  std::deque<TrackedFrame> recent_;       // tracked without interruption until `previous_`, oldest first
  LocalMap local_map_;
  MotionModel motion_;
  State state_;
};

}  // namespace kinloop
