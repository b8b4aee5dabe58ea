#include "kinloop/tracking/tracker.hpp"

#include <algorithm>
#include <cstring>

#include <opencv2/core.hpp>

#include "kinloop/belief/hand_motion.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"
#include "kinloop/tracking/direct/direct_tracking.hpp"
#include "kinloop/tracking/evidence/confirmed_first.hpp"
#include "kinloop/tracking/evidence/moved_points.hpp"
#include "kinloop/tracking/evidence/surface_evidence.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/motion/motion_compensation.hpp"

namespace kinloop {
namespace {

int count_with_depth(const Features& features) {
  return static_cast<int>(std::count_if(features.depths_m.begin(), features.depths_m.end(),
                                        [](float depth_m) { return depth_m > 0; }));
}

/// Whether the frame matches enough of the map to be localized without previous frames.
bool is_localized(const TrackedFrame& tracked, const Frame& frame, const TrackingOptions& options) {
  return tracked.evidence.inliers >= options.min_inliers &&
         has_sufficient_inlier_ratio(tracked, *frame.features, options.min_inlier_ratio);
}

/// Behind something that moves, the mapped place comes into view again within this time.
constexpr int64_t kMaxHidden_ns = 5 * kNsPerSecond;

/// Ends at the first row that differs.
bool have_equal_pixels(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty() || a.size() != b.size() || a.type() != b.type()) return false;
  const size_t row_bytes = a.elemSize() * static_cast<size_t>(a.cols);
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), row_bytes) != 0) return false;
  }
  return true;
}

/// Keeps since when something holds; nullopt if it does not.
void keep_since(std::optional<int64_t>& since_ns, bool holds, int64_t now_ns) {
  if (!holds) {
    since_ns.reset();
  } else if (!since_ns) {
    since_ns = now_ns;
  }
}

/// Whether few landmarks support a pose, such that it may follow what moves.
bool has_few_inliers(const TrackedFrame& tracked) {
  return tracked.evidence.inliers < kMinConfirmed;
}

/// Whether hardly any of the landmarks in view are found although all keypoints were extracted. Those that
/// are may be on something that moves.
bool has_low_recall(const TrackedFrame& tracked, const Features& features) {
  return tracked.method == TrackingMethod::kKeypoints && misses_landmarks(tracked, features);
}

}  // namespace

TrackedFrame Tracker::track(const Frame& measured, const TrackingContext& context) const {
  if (repeats_previous_image(measured)) return repeat_previous(measured);
  const Frame frame = without_moved(measured);
  const auto by_patches = track_by_patches(frame, context.sensor);
  TrackedFrame tracked = by_patches ? with_motion(*by_patches, *by_patches->frame, context.sensor)
                                    : track_by_keypoints(frame, context);
  if (!is_in_long_doubt(tracked)) return tracked;
  if (auto elsewhere = find_elsewhere(tracked, measured, context)) return *std::move(elsewhere);
  if (auto started = start_map_after_doubt(tracked, frame, context.sensor)) return *std::move(started);
  return tracked;
}

/// Whether a pose has been in doubt for so long that the place should be recognized anew: the camera may
/// follow what moves, and take what is at rest for moving. Not at every frame, since recognition is slow.
bool Tracker::is_in_long_doubt(const TrackedFrame& tracked) const {
  constexpr int64_t kMinDoubt_ns = kNsPerSecond / 2;
  constexpr uint32_t kInterval = 5;
  return tracked.is_located() && tracked.is_doubtful() && state_.doubtful_since_ns &&
         tracked.stamp_ns - *state_.doubtful_since_ns > kMinDoubt_ns && tracked.id.value % kInterval == 0;
}

/// Returns the frame where it is recognized beyond doubt, if that is not where it was tracked.
std::optional<TrackedFrame> Tracker::find_elsewhere(const TrackedFrame& tracked, Frame measured,
                                                    const TrackingContext& context) const {
  constexpr double kMaxDistance_m = 0.1, kMaxAngle_rad = 0.1;
  const ScopedTimer timer(timings_, "relocalization");
  measured = with_features(std::move(measured));
  auto found = context.relocalize(deskewed(measured, context.sensor, tracked.velocity));
  const Map& map = context.map;
  if (!found || !is_confident(*found, *measured.features) || !is_reachable(*found, map)) return std::nullopt;
  const SE3 T_found_tracked = found->world(map).inverse() * tracked.world(map);
  if (is_tracked_in(map.keyframe(found->reference).component, tracked, map) &&
      T_found_tracked.translation.norm() < kMaxDistance_m && T_found_tracked.angle_rad() < kMaxAngle_rad)
    return std::nullopt;
  return with_motion(*std::move(found), std::move(measured), context.sensor);
}

/// Starts a new part of the map if hardly any landmark has supported the pose for so long that the camera is
/// probably where none has been mapped: in doubt, no keyframe is made that would extend the map.
std::optional<TrackedFrame> Tracker::start_map_after_doubt(const TrackedFrame& tracked, Frame frame,
                                                           const Sensor& sensor) const {
  if (!may_start_component() || tracked.outcome != TrackingOutcome::kTracked || !remains_weak(tracked) ||
      tracked.stamp_ns - *state_.doubtful_since_ns < kMaxHidden_ns)
    return std::nullopt;
  frame = with_features(std::move(frame));
  TrackedFrame started = start_map_or_lose(frame);
  if (started.is_lost()) return std::nullopt;
  return with_motion(std::move(started), std::move(frame), sensor);
}

/// Extracts the keypoints of a frame that was tracked by patches.
Frame Tracker::with_features(Frame frame) const {
  if (!frame.features) frame.features = front_end_.features(frame);
  return frame;
}

/// Leaves out the keypoints and the depth of what moved in the previous frame, but not its surfaces, which
/// tell whether it still does.
Frame Tracker::without_moved(const Frame& frame) const {
  if (!previous_ || state_.lost_frames > 0 || previous_->moved.empty() || !frame.surfaces) return frame;
  return front_end_.ignore(frame,
                           unmarked_pixels(*frame.surfaces->camera, previous_->moved, frame.gray.size()),
                           IgnoreCause::kMoved);
}

/// Drivers repeat the previous image in place of a lost one: the camera has moved, the image has not. Images
/// without landmarks, such as those of a covered lens, may be equal although the camera moves.
bool Tracker::repeats_previous_image(const Frame& frame) const {
  return previous_ && state_.lost_frames == 0 && !previous_->matches.empty() &&
         have_equal_pixels(previous_->frame->gray, frame.gray);
}

TrackedFrame Tracker::repeat_previous(Frame frame) const {
  TrackedFrame tracked = *previous_;
  tracked.id = frame.id;
  tracked.stamp_ns = frame.stamp_ns;
  tracked.outcome = TrackingOutcome::kTracked;
  tracked.method = TrackingMethod::kRepeat;
  tracked.keyframe = {};
  tracked.evidence = {};
  tracked.evidence.inliers = static_cast<int>(tracked.matches.size());
  // One image lost in transfer is bridged well; a camera whose image is frozen may be anywhere.
  constexpr int64_t kMaxRepeat_ns = kNsPerSecond / 5;
  if (frame.stamp_ns - previous_->stamp_ns > kMaxRepeat_ns) doubt(tracked, DoubtCause::kFrozen);
  frame.features = previous_->frame->features;
  tracked.frame = std::make_shared<const Frame>(std::move(frame));
  return tracked;
}

/// Tracks against patches of the local map. Not after a loss, when the prediction is unknown.
std::optional<TrackedFrame> Tracker::track_by_patches(const Frame& frame, const Sensor& sensor) const {
  const ScopedTimer timer(timings_, "direct tracking");
  constexpr int64_t kMaxGap_ns = kNsPerSecond / 10;  // patches look too different after a longer motion
  if (!previous_ || state_.lost_frames > 0 || options_.localize_only || state_.hypothesis_since_ns)
    return std::nullopt;
  if (frame.stamp_ns - previous_->stamp_ns > kMaxGap_ns) return std::nullopt;
  const PatchSearch search{local_map_, sensor, motion_.velocity()};
  return track_directly(frame, predict(frame.stamp_ns).T,
                        {*previous_, search, options_.features, options_.tracking});
}

TrackedFrame Tracker::track_by_keypoints(Frame frame, const TrackingContext& context) const {
  if (!frame.features) {
    const ScopedTimer timer(timings_, "features");
    frame.features = front_end_.features(frame);
  }
  TrackedFrame tracked = locate(deskewed(frame, context.sensor, motion_.velocity()), context);
  constexpr int64_t kMaxHypothesis_ns = kNsPerSecond;
  if (state_.hypothesis_since_ns && frame.stamp_ns - *state_.hypothesis_since_ns > kMaxHypothesis_ns &&
      !is_confident(tracked, *frame.features))
    tracked = unlocated(frame);
  if (options_.localize_only && tracked.is_located() && !is_localized(tracked, frame, options_.tracking)) {
    tracked.matches.clear();
  }
  return with_motion(std::move(tracked), std::move(frame), context.sensor);
}

TrackedFrame Tracker::locate(const Frame& frame, const TrackingContext& context) const {
  if (context.map.keyframes().empty()) return start_map_or_lose(frame);
  TrackedFrame tracked = track_from_previous(frame, context.sensor).value_or(unlocated(frame));
  // Dense odometry measures the motion between consecutive frames, not across a gap.
  const bool continuous = continues_previous(frame);
  if (!continuous && tracked.method == TrackingMethod::kDense) tracked = unlocated(frame);
  const bool expected = continuous && tracked.evidence.attempts == 1;
  if (!expected && tracked.is_located() && is_contradicted(tracked, frame)) tracked = unlocated(frame);
  if (continuous && tracked.is_lost()) {
    tracked = track_densely({frame, local_map_, context.sensor, options_.tracking}, *previous_,
                            predict(frame.stamp_ns));
    if (tracked.is_located() && is_contradicted(tracked, frame)) tracked = unlocated(frame);
  }
  const bool as_predicted = tracked.evidence.attempts == 1 &&
                            (!options_.localize_only || is_localized(tracked, frame, options_.tracking));
  if (tracked.is_located() && tracked.method != TrackingMethod::kDense && as_predicted) {
    // Later frames have to confirm a jump, as they have to confirm a place.
    if (continuous && jumps(tracked, frame)) tracked.outcome = TrackingOutcome::kRelocalized;
    return tracked;
  }

  // A camera far from its predicted pose may have been moved while it was lost: relocalization is more
  // reliable than a few chance matches.
  const ScopedTimer timer(timings_, "relocalization");
  auto found = context.relocalize(frame);
  if (found && found->evidence.inliers > tracked.evidence.inliers && is_reachable(*found, context.map))
    return *std::move(found);
  if (tracked.is_located()) return tracked;
  return may_be_elsewhere(frame) ? start_map_or_lose(frame) : tracked;
}

/// Whether the camera can have moved there since its last trusted pose.
bool Tracker::is_reachable(const TrackedFrame& found, const Map& map) const {
  if (!trusted_ || !is_tracked_in(map.keyframe(trusted_->pose.reference).component, found, map)) return true;
  return can_reach(*trusted_, map, found.world(map).translation, found.stamp_ns);
}

/// Whether the camera was relocalized and this frame does not confirm it.
bool Tracker::is_hypothesis(const TrackedFrame& tracked) const {
  const bool unexpected = tracked.outcome == TrackingOutcome::kRelocalized || state_.hypothesis_since_ns;
  return tracked.is_located() &&
         (tracked.provisional || (unexpected && !is_confident(tracked, tracked.features())));
}

bool Tracker::may_start_component() const {
  return options_.lost_frames_before_new_component > 0;
}

/// Whether the camera has been lost for so long that it may be in an unmapped place. Behind something that
/// moves, the mapped place comes into view again, and a map of what hides it would be worse than none.
bool Tracker::may_be_elsewhere(const Frame& frame) const {
  if (!may_start_component() || state_.lost_frames < options_.lost_frames_before_new_component) return false;
  const bool hidden = state_.moved_ns && state_.lost_since_ns - *state_.moved_ns < kNsPerSecond;
  return !hidden || frame.stamp_ns - state_.lost_since_ns > kMaxHidden_ns;
}

/// Whether the motion since the previous frame can be predicted.
bool Tracker::continues_previous(const Frame& frame) const {
  constexpr int64_t kMaxInterval_ns = kNsPerSecond / 4;  // hand motion reverses within a longer gap
  return previous_ && state_.lost_frames == 0 && frame.stamp_ns - previous_->stamp_ns <= kMaxInterval_ns;
}

/// Whether the motion of a hand does not explain a pose on few landmarks. Where depth comes back, a jump may
/// be right.
bool Tracker::jumps(const TrackedFrame& tracked, const Frame& frame) const {
  const auto sees_depth = [](const Frame& seen) { return seen.surfaces && has_depth(*seen.surfaces); };
  if (!sees_depth(frame) || !sees_depth(*previous_->frame)) return false;
  return !is_explained(expected_view(tracked.stamp_ns), tracked.T_reference_camera) &&
         !is_confident(tracked, *frame.features);
}

/// Whether surfaces contradict a pose found relative to the local map.
bool Tracker::is_contradicted(const TrackedFrame& tracked, const Frame& frame) const {
  const double turning_rad_s = continues_previous(frame) ? previous_->velocity.angular_rad_s.norm() : 0;
  const auto contradicts = [&](const SurfaceAgreement& agreement) {
    return contradicts_unexpected_pose(agreement, tracked, frame, turning_rad_s);
  };
  const SE3& T_reference_camera = tracked.T_reference_camera;
  if (contradicts(agreement_with_reference(local_map_, frame, T_reference_camera))) return true;
  if (!frame.surfaces || !previous_->frame->surfaces) return false;
  return contradicts(compare_surfaces(*previous_->frame->surfaces, *frame.surfaces,
                                      previous_->T_reference_camera.inverse() * T_reference_camera));
}

std::optional<TrackedFrame> Tracker::track_from_previous(const Frame& frame, const Sensor& sensor) const {
  if (!previous_) return std::nullopt;
  TrackedFrame previous = *previous_;
  if (!previous.features().has_descriptors()) {
    previous = rematch_keypoints(*previous_, sensor);
    previous.T_reference_camera = previous_->T_reference_camera;
  }
  const ScopedTimer timer(timings_, "tracking");
  return track_keypoints({frame, local_map_, sensor, options_.tracking}, previous, predict(frame.stamp_ns),
                         hash(options_.seed, frame.id.value));
}

TrackedFrame Tracker::rematch_keypoints(const TrackedFrame& tracked, const Sensor& sensor) const {
  Frame frame = *tracked.frame;
  {
    const ScopedTimer timer(timings_, "features");
    frame.features = front_end_.features(frame);
  }
  const auto measured = frame.features;
  frame = deskewed(std::move(frame), sensor, tracked.velocity);
  const ScopedTimer timer(timings_, "tracking");
  TrackedFrame rematched =
      track_local_map({frame, local_map_, sensor, options_.tracking}, tracked.T_reference_camera,
                      options_.tracking.local_map_window_px, without_pose(tracked));
  rematched.evidence.attempts = 1;
  rematched.evidence.with_depth = count_with_depth(rematched.matches, local_map_);
  rematched = with_motion_prior(std::move(rematched), *measured, sensor);
  rematched.trust = tracked.trust;
  if (has_low_recall(rematched, *frame.features)) doubt(rematched, DoubtCause::kHidden);
  rematched.frame = std::make_shared<const Frame>(std::move(frame));
  return rematched;
}

PredictedPose Tracker::predict(int64_t stamp_ns) const {
  PredictedPose predicted = motion_.predict(stamp_ns - previous_->stamp_ns);
  predicted.T = previous_->T_reference_camera * predicted.T;
  return predicted;
}

/// The predicted pose with the covariance that the motion of a hand gives it.
PredictedView Tracker::expected_view(int64_t stamp_ns) const {
  const double interval_s = to_seconds(stamp_ns - previous_->stamp_ns);
  return {predict(stamp_ns).T, hand_motion_covariance(interval_s, interval_s)};
}

/// A map starts with a frame that has enough keypoints.
TrackedFrame Tracker::start_map_or_lose(const Frame& frame) const {
  TrackedFrame tracked = unlocated(frame);
  const bool enough = count_with_depth(*frame.features) >= options_.min_initial_keypoints;
  if (!options_.localize_only && enough) tracked.outcome = TrackingOutcome::kNewMap;
  return tracked;
}

/// Adds what follows from the pose: its evidence in the surfaces, the velocity, and the frame compensated for
/// it.
TrackedFrame Tracker::with_motion(TrackedFrame tracked, Frame measured, const Sensor& sensor) const {
  tracked.velocity = velocity_of(tracked);
  tracked = with_motion_prior(std::move(tracked), *measured.features, sensor);
  if (tracked.is_located() && tracked.reference == local_map_.reference) {
    const ScopedTimer timer(timings_, "surface evidence");
    tracked.evidence.with_depth = count_with_depth(tracked.matches, local_map_);
    find_moved(tracked, measured);
    const bool doubtful_before = follows_doubtful_pose();
    tracked.trust = {};
    doubt(tracked, cause_of_doubt(tracked, doubtful_before, options_.max_predicted_sigma_m));
    if (has_low_recall(tracked, *measured.features)) doubt(tracked, DoubtCause::kHidden);
    if (remains_weak(tracked)) doubt(tracked, DoubtCause::kFewLandmarks);
    // Odometry carries on what was wrong with the previous pose.
    if (doubtful_before && tracked.evidence.inliers < options_.tracking.min_inliers)
      doubt(tracked, previous_->trust.cause);
  }
  tracked.frame = std::make_shared<const Frame>(deskewed(std::move(measured), sensor, tracked.velocity));
  if (tracked.is_located() && lacks_scale(tracked, state_.lacks_scale)) doubt(tracked, DoubtCause::kScale);
  if (tracked.is_located() && is_hypothesis(tracked)) doubt(tracked, DoubtCause::kPlace);
  return tracked;
}

/// Compares the surfaces with those of the local map. Adds what has moved, and how well the others agree.
void Tracker::find_moved(TrackedFrame& tracked, const Frame& frame) const {
  constexpr double kMinContradicted = 0.03;
  const SE3& T_reference_camera = tracked.T_reference_camera;
  SurfaceAgreement& agreement = tracked.evidence.surfaces;
  agreement = agreement_with_reference(local_map_, frame, T_reference_camera);
  const bool moved_before = previous_ && state_.lost_frames == 0 && !previous_->moved.empty();
  if (!moved_before && agreement.contradicted_share() < kMinContradicted) return;
  tracked.moved = moved_points(local_map_, frame, T_reference_camera);
  if (tracked.moved.empty()) return;
  tracked.evidence.moved_share = marked_share(tracked.moved);
  agreement = compare_surfaces(*local_map_.surfaces, without_points(*frame.surfaces, tracked.moved),
                               T_reference_camera);
}

void Tracker::find_moving(TrackedFrame& tracked, const Sensor& sensor) const {
  const ScopedTimer timer(timings_, "moving keypoints");
  if (!tracked.is_located() || recent_.empty() || recent_.back().reference != tracked.reference) return;
  // In a tenth of a second, what moves is displaced by more than the keypoints are imprecise.
  constexpr int64_t kMinInterval_ns = kNsPerSecond / 11;
  const auto is_old_enough = [&](const TrackedFrame& frame) {
    return tracked.stamp_ns - frame.stamp_ns >= kMinInterval_ns;
  };
  const auto newest = std::find_if(recent_.rbegin(), recent_.rend(), is_old_enough);
  const TrackedFrame& earlier = newest == recent_.rend() ? recent_.front() : *newest;
  const SE3 T_earlier_tracked = earlier.T_reference_camera.inverse() * tracked.T_reference_camera;
  tracked.moved = marked_in_either(tracked.moved, moving_points(tracked, earlier, T_earlier_tracked, sensor));
}

/// Whether the previous frame has a pose that is in doubt.
bool Tracker::follows_doubtful_pose() const {
  return previous_ && state_.lost_frames == 0 && previous_->is_doubtful();
}

/// Whether the pose of the previous frame may be far off: few landmarks supported it, and it is in doubt.
bool Tracker::follows_weak_pose() const {
  return follows_doubtful_pose() && has_few_inliers(*previous_);
}

/// Whether few landmarks support a pose that follows such a one.
bool Tracker::remains_weak(const TrackedFrame& tracked) const {
  return has_few_inliers(tracked) && follows_weak_pose();
}

/// Whether the motion from the previous frame is known.
bool Tracker::follows_previous(const TrackedFrame& tracked) const {
  return tracked.outcome == TrackingOutcome::kTracked && previous_ && state_.lost_frames == 0 &&
         !state_.depth_was_frozen && !follows_weak_pose();
}

/// Returns the velocity since the previous frame; zero if it is unknown.
Velocity Tracker::velocity_of(const TrackedFrame& tracked) const {
  if (!follows_previous(tracked)) return {};
  return motion_.velocity_of(previous_->T_reference_camera.inverse() * tracked.T_reference_camera,
                             tracked.stamp_ns - previous_->stamp_ns);
}

/// Where the landmarks leave the pose uncertain, lets the motion before decide; likewise the velocity. Both
/// are estimated from the keypoints as they were measured.
TrackedFrame Tracker::with_motion_prior(TrackedFrame tracked, const Features& measured,
                                        const Sensor& sensor) const {
  if (!tracked.is_tracked_by_landmarks() || !follows_previous(tracked) ||
      tracked.reference != local_map_.reference || previous_->reference != local_map_.reference)
    return tracked;
  const auto prior = motion_.prior(previous_->T_reference_camera, tracked.stamp_ns - previous_->stamp_ns);
  if (!prior || !MotionModel::agrees(*prior, tracked.T_reference_camera, tracked.covariance)) return tracked;
  std::vector<PoseObservation> observations;
  for (const auto& [landmark, feature] : tracked.matches) {
    const auto known = local_map_.index_of.find(landmark);
    if (known == local_map_.index_of.end()) continue;
    observations.push_back(
        {raw_measurement(measured, feature, sensor.camera.height), local_map_.p_reference[known->second]});
  }
  const auto found =
      solve_moving_pose(sensor, observations, tracked.T_reference_camera, *prior, options_.tracking.pose);
  if (!found) return tracked;
  tracked.T_reference_camera = found->T_world_camera;
  tracked.velocity = found->velocity;
  return tracked;
}

/// Returns the frame as an ideal global-shutter camera would have measured it, given its motion.
Frame Tracker::deskewed(Frame measured, const Sensor& sensor, const Velocity& velocity) const {
  const ScopedTimer timer(timings_, "motion compensation");
  if (needs_deskewing(*measured.features, sensor)) {
    measured.features =
        std::make_shared<const Features>(deskew_features(*measured.features, sensor, velocity));
  }
  return measured;
}

void Tracker::update(const TrackedFrame& latest, const Map& map) {
  const ScopedTimer timer(timings_, "local map");
  if (!latest.is_repeat()) remember(latest);
  const KeyframeId reference =
      latest.keyframe.valid() ? latest.keyframe : best_reference(map, latest.matches, local_map_.reference);
  if (!reference.valid()) return;
  express_previous_in(reference, map);
  if (reference != local_map_.reference) local_map_ = make_local_map(map, reference, options_.local_map);
}

void Tracker::update(const Map& map, KeyframeId reference) {
  if (!reference.valid()) return;
  express_previous_in(reference, map);
  local_map_ = make_local_map(map, reference, options_.local_map);
}

void Tracker::update(const Map& map, KeyframeId reference, const SE3& T_reference_old) {
  if (previous_) {
    previous_->T_reference_camera = T_reference_old * previous_->T_reference_camera;
    previous_->reference = reference;
  }
  recent_.clear();
  update(map, reference);
}

void Tracker::set_first_velocity(const Velocity& velocity, int64_t interval_ns, const Map& map) {
  Frame frame = *previous_->frame;
  frame.features = map.keyframe(previous_->keyframe).features;
  previous_->frame = std::make_shared<const Frame>(std::move(frame));
  previous_->velocity = velocity;
  motion_.update(velocity, interval_ns);
  update(map, previous_->keyframe);
}

void Tracker::forget_motion() {
  motion_.reset();
  state_.depth_was_frozen = true;
}

void Tracker::reset() {
  previous_.reset();
  trusted_.reset();
  recent_.clear();
  local_map_ = {};
  motion_.reset();
  state_ = {};
}

void Tracker::express_previous_in(KeyframeId reference, const Map& map) {
  const auto express = [&](KeyframePose& pose) {
    if (pose.reference.valid()) pose = pose.in(reference, map);
  };
  if (previous_) express(*previous_);
  if (trusted_ && map.keyframe(trusted_->pose.reference).withdrawn) express(trusted_->pose);
  for (TrackedFrame& frame : recent_) express(frame);
}

/// Keeps the frames of the last fifth of a second, up to a loss or a jump.
void Tracker::keep_recent(const TrackedFrame& latest) {
  constexpr int64_t kDuration_ns = kNsPerSecond / 5;
  if (latest.outcome != TrackingOutcome::kTracked) recent_.clear();
  recent_.push_back(latest);
  while (latest.stamp_ns - recent_.front().stamp_ns > kDuration_ns) recent_.pop_front();
}

/// Stores what the next frame needs. After a loss this is the last frame with a pose.
void Tracker::remember(const TrackedFrame& latest) {
  if (follows_previous(latest)) {
    const int64_t duration_ns = latest.stamp_ns - previous_->stamp_ns;
    if (latest.is_tracked_by_landmarks()) {
      motion_.update(latest.velocity, duration_ns, latest.covariance);
    } else {
      motion_.update(latest.velocity, duration_ns);
    }
  } else {
    motion_.reset();
  }
  state_.depth_was_frozen = false;
  // Not by keypoints alone, which also seem to move at the edge of a mask.
  if (latest.evidence.moved_share > 0) state_.moved_ns = latest.stamp_ns;
  if (latest.is_lost() && state_.hypothesis_since_ns) previous_.reset();  // it may have been elsewhere
  keep_since(state_.hypothesis_since_ns, is_hypothesis(latest), latest.stamp_ns);
  if (latest.is_lost()) {
    if (state_.lost_frames++ == 0) state_.lost_since_ns = latest.stamp_ns;
  } else {
    keep_since(state_.doubtful_since_ns, latest.is_doubtful(), latest.stamp_ns);
    state_.lacks_scale = latest.is_located() && lacks_scale(latest, state_.lacks_scale);
    state_.lost_frames = 0;
    previous_ = latest;
    if (!latest.is_doubtful() && latest.reference.valid())
      trusted_ = {latest, latest.velocity, latest.stamp_ns};
    keep_recent(latest);
  }
}

bool Tracker::expects_keypoints() const {
  return !previous_ || previous_->features().has_descriptors() || state_.lost_frames > 0 ||
         state_.hypothesis_since_ns;
}

}  // namespace kinloop
