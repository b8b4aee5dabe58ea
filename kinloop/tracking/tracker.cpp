#include "kinloop/tracking/tracker.hpp"

#include <algorithm>
#include <cstring>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/tracking/motion_compensation.hpp"

namespace kinloop {
namespace {

int count_with_depth(const Features& features) {
  return static_cast<int>(std::count_if(features.depths_m.begin(), features.depths_m.end(),
                                        [](float depth_m) { return depth_m > 0; }));
}

/// Whether the frame matches enough of the map to be localized without previous frames.
bool is_localized(const TrackResult& result, const PreparedFrame& frame, const TrackingOptions& options) {
  return result.stats.inliers >= options.min_inliers &&
         has_sufficient_inlier_ratio(result, *frame.features, options.min_inlier_ratio);
}

TrackResult* located(TrackOutcome& outcome) {
  if (auto* tracked = std::get_if<Tracked>(&outcome)) return &tracked->result;
  if (auto* relocalized = std::get_if<Relocalized>(&outcome)) return &relocalized->result;
  return nullptr;
}

/// Ends at the first row that differs.
bool have_equal_pixels(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty() || a.size() != b.size() || a.type() != b.type()) return false;
  const size_t row_bytes = a.elemSize() * static_cast<size_t>(a.cols);
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), row_bytes) != 0) return false;
  }
  return true;
}

}  // namespace

const TrackResult* located(const TrackOutcome& outcome) {
  if (const auto* tracked = std::get_if<Tracked>(&outcome)) return &tracked->result;
  if (const auto* relocalized = std::get_if<Relocalized>(&outcome)) return &relocalized->result;
  return nullptr;
}

FrameTracking Tracker::track(const PreparedFrame& measured, const TrackingContext& context,
                             Timings& timings) const {
  if (repeats_previous_image(measured)) return repeat_previous(measured);
  Stopwatch watch;
  auto direct = track_directly(measured, context.sensor);
  timings.add("direct tracking", watch.lap());
  if (!direct) return track_by_keypoints(measured, context, timings);
  PreparedFrame frame = measured;
  frame.features = std::move(direct->features);
  FrameTracking tracking = complete(Tracked{std::move(direct->result)}, frame, context.sensor, timings);
  tracking.direct = true;
  tracking.has_keypoints = false;
  return tracking;
}

FrameTracking Tracker::repeat_previous(const PreparedFrame& measured) const {
  FrameTracking tracking{Tracked{previous_result()}, measured, motion_, true};
  tracking.frame.features = previous_->frame.features;
  return tracking;
}

/// Tracks against patches of the local map. Not after a loss, when the prediction is unknown.
std::optional<DirectlyTracked> Tracker::track_directly(const PreparedFrame& measured,
                                                       const Sensor& sensor) const {
  constexpr int64_t kMaxGap_ns = kNsPerSecond / 10;  // patches look too different after a longer motion
  if (!previous_ || lost_frames_ > 0 || options_.localize_only) return std::nullopt;
  if (measured.stamp_ns - previous_->frame.stamp_ns > kMaxGap_ns) return std::nullopt;
  const PatchSearch search{local_map_, sensor, motion_.velocity()};
  const DirectTrackingContext context{*previous_, search, options_.features, options_.tracking};
  return kinloop::track_directly(measured, predict(measured.stamp_ns).T, context);
}

FrameTracking Tracker::track_by_keypoints(PreparedFrame measured, const TrackingContext& context,
                                          Timings& timings) const {
  Stopwatch watch;
  if (!measured.features) measured.features = front_end_.features(measured);
  timings.add("features", watch.lap());
  const PreparedFrame predicted = deskewed(measured, context.sensor, motion_);
  timings.add("motion compensation", watch.lap());
  TrackOutcome outcome = locate(predicted, context, timings);
  TrackResult* result = located(outcome);
  if (options_.localize_only && result != nullptr && !is_localized(*result, measured, options_.tracking)) {
    result->matches.clear();
  }
  return complete(std::move(outcome), measured, context.sensor, timings);
}

/// Adds what follows from the outcome: the motion, and the frame compensated for it.
FrameTracking Tracker::complete(TrackOutcome outcome, const PreparedFrame& measured, const Sensor& sensor,
                                Timings& timings) const {
  const Stopwatch watch;
  const MotionModel motion = motion_after(measured, outcome);
  PreparedFrame frame = deskewed(measured, sensor, motion);
  timings.add("motion compensation", watch.elapsed());
  return {std::move(outcome), std::move(frame), motion};
}

FrameTracking Tracker::with_keypoints(const FrameTracking& tracked, const TrackingContext& context,
                                      Timings& timings) const {
  FrameTracking all = tracked;
  all.has_keypoints = true;
  TrackResult result = track_all_keypoints(all.frame, located(tracked.outcome)->T_reference_camera,
                                           context.sensor, tracked.motion, timings);
  result.stats.attempts = 1;
  if (result.status == TrackStatus::kTracked) {
    all.outcome = Tracked{std::move(result)};
  } else {
    all.outcome = Lost{result.stats};
  }
  return all;
}

/// The previous frame with all its keypoints, even if it was tracked without.
TrackedFrame Tracker::previous_with_keypoints(const Sensor& sensor, Timings& timings) const {
  if (previous_has_keypoints_) return *previous_;
  TrackedFrame previous = *previous_;
  const TrackResult result =
      track_all_keypoints(previous.frame, previous.T_reference_camera, sensor, motion_, timings);
  previous.landmark_of.assign(previous.frame.features->size(), LandmarkId{});
  for (const LandmarkMatch& match : result.matches) previous.landmark_of[match.feature] = match.landmark;
  return previous;
}

/// Extracts the keypoints of a frame that was tracked directly, and matches them from its pose.
TrackResult Tracker::track_all_keypoints(PreparedFrame& frame, const SE3& T_reference_camera,
                                         const Sensor& sensor, const MotionModel& motion,
                                         Timings& timings) const {
  Stopwatch watch;
  frame.features = front_end_.features(frame);
  timings.add("features", watch.lap());
  frame = deskewed(frame, sensor, motion);
  timings.add("motion compensation", watch.lap());
  TrackResult result = track_local_map({frame, local_map_, sensor, options_.tracking}, T_reference_camera,
                                       options_.tracking.local_map_window_px);
  timings.add("tracking", watch.lap());
  return result;
}

PredictedPose Tracker::predict(int64_t stamp_ns) const {
  PredictedPose predicted = motion_.predict(stamp_ns - previous_->frame.stamp_ns);
  predicted.T = previous_->T_reference_camera * predicted.T;
  return predicted;
}

TrackOutcome Tracker::locate(const PreparedFrame& frame, const TrackingContext& context,
                             Timings& timings) const {
  if (context.map.keyframes().empty()) return start_map_or_lose(frame);
  std::optional<TrackedFrame> previous;
  if (previous_) previous = previous_with_keypoints(context.sensor, timings);
  const Stopwatch watch;
  TrackResult tracked = previous ? track_previous(frame, *previous, context.sensor) : TrackResult{};
  timings.add("tracking", watch.elapsed());
  // Dense odometry measures the motion between consecutive frames, not across a gap.
  if (lost_frames_ > 0 && tracked.status == TrackStatus::kDenseOnly) tracked = {};
  const bool as_predicted = tracked.stats.attempts == 1 &&
                            (!options_.localize_only || is_localized(tracked, frame, options_.tracking));
  if (tracked.status == TrackStatus::kTracked && as_predicted) return Tracked{std::move(tracked)};

  // A camera far from its predicted pose may have been moved while it was lost: relocalization is more
  // reliable than a few chance matches.
  const Stopwatch relocalization_watch;
  auto found = context.relocalize(frame);
  timings.add("relocalization", relocalization_watch.elapsed());
  if (found && found->stats.inliers > tracked.stats.inliers) return Relocalized{std::move(*found)};
  if (tracked.status != TrackStatus::kLost) return Tracked{std::move(tracked)};
  // After this many lost frames the camera may be in an unmapped place.
  const int max_lost = options_.lost_frames_before_new_component;
  if (max_lost > 0 && lost_frames_ >= max_lost) return start_map_or_lose(frame);
  return Lost{tracked.stats};
}

TrackResult Tracker::track_previous(const PreparedFrame& frame, const TrackedFrame& previous,
                                    const Sensor& sensor) const {
  return kinloop::track({frame, local_map_, sensor, options_.tracking}, previous, predict(frame.stamp_ns),
                        hash(options_.seed, frame.id.value));
}

/// A map starts with a frame that has enough keypoints.
TrackOutcome Tracker::start_map_or_lose(const PreparedFrame& frame) const {
  const bool enough = count_with_depth(*frame.features) >= options_.min_initial_keypoints;
  if (options_.localize_only || !enough) return Lost{};
  return NewMap{};
}

/// Drivers repeat the previous image in place of a lost one: the camera has moved, the image has not. Images
/// without landmarks, such as those of a covered lens, may be equal although the camera moves.
bool Tracker::repeats_previous_image(const PreparedFrame& frame) const {
  if (!previous_ || lost_frames_ > 0) return false;
  const auto& landmarks = previous_->landmark_of;
  if (std::none_of(landmarks.begin(), landmarks.end(), [](LandmarkId id) { return id.valid(); }))
    return false;
  return have_equal_pixels(previous_->frame.gray, frame.gray);
}

TrackResult Tracker::previous_result() const {
  TrackResult result;
  result.status = TrackStatus::kTracked;
  result.reference = local_map_.reference;
  result.T_reference_camera = previous_->T_reference_camera;
  for (uint32_t i = 0; i < previous_->landmark_of.size(); ++i) {
    if (previous_->landmark_of[i].valid()) result.matches.push_back({previous_->landmark_of[i], i});
  }
  result.stats.inliers = static_cast<int>(result.matches.size());
  return result;
}

/// Updates the motion model from two consecutively tracked frames; otherwise the velocity is unknown.
MotionModel Tracker::motion_after(const PreparedFrame& frame, const TrackOutcome& outcome) const {
  MotionModel motion = motion_;
  const auto* tracked = std::get_if<Tracked>(&outcome);
  if (tracked != nullptr && previous_ && lost_frames_ == 0) {
    motion.update(previous_->T_reference_camera.inverse() * tracked->result.T_reference_camera,
                  frame.stamp_ns - previous_->frame.stamp_ns);
  } else {
    motion.reset();
  }
  return motion;
}

/// Returns the frame as an ideal global-shutter camera would have measured it, given its motion.
PreparedFrame Tracker::deskewed(const PreparedFrame& measured, const Sensor& sensor,
                                const MotionModel& motion) const {
  PreparedFrame frame = measured;
  if (needs_deskewing(*measured.features, sensor)) {
    frame.features =
        std::make_shared<const Features>(deskew_features(*measured.features, sensor, motion.velocity()));
  }
  return frame;
}

void Tracker::update(const Map& map, KeyframeId reference, const FrameTracking* latest) {
  KeyframeId previous_reference = local_map_.reference;  // the reference of the previous frame's pose
  if (latest != nullptr && !latest->repeat) {
    remember(*latest);
    const TrackResult* result = located(latest->outcome);
    if (result != nullptr) previous_reference = result->reference;
    if (std::holds_alternative<NewMap>(latest->outcome)) previous_reference = reference;
  }
  if (!reference.valid()) return;
  if (previous_ && previous_reference.valid() && previous_reference != reference) {
    previous_->T_reference_camera = map.keyframe(reference).T_world_camera.inverse() *
                                    map.keyframe(previous_reference).T_world_camera *
                                    previous_->T_reference_camera;
  }
  const bool map_unchanged = latest != nullptr && reference == local_map_.reference;
  if (!map_unchanged) local_map_ = make_local_map(map, reference, options_.local_map);
}

/// Stores what the next frame needs. After a loss this is the last located frame.
void Tracker::remember(const FrameTracking& latest) {
  motion_ = latest.motion;
  if (std::holds_alternative<Lost>(latest.outcome)) {
    ++lost_frames_;
    return;
  }
  lost_frames_ = 0;
  previous_has_keypoints_ = latest.has_keypoints;
  const TrackResult* result = located(latest.outcome);
  previous_ = TrackedFrame{latest.frame, result != nullptr ? result->T_reference_camera : SE3{},
                           std::vector<LandmarkId>(latest.frame.features->size())};
  if (result == nullptr) return;
  for (const LandmarkMatch& match : result->matches) previous_->landmark_of[match.feature] = match.landmark;
}

}  // namespace kinloop
