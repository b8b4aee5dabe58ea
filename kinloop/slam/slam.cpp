#include "kinloop/slam/slam.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/back_end/final/revise_doubt.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/sensor/depth_sensor.hpp"
#include "kinloop/tracking/evidence/surface_evidence.hpp"
#include "kinloop/tracking/motion/motion_compensation.hpp"

namespace kinloop {
namespace {

/// Adds the time of its scope to that of the latest frame.
class FrameTimer {
 public:
  explicit FrameTimer(Timings& timings) : timings_(timings) {}
  ~FrameTimer() { timings_.frame_ms.back() += 1e3 * watch_.wall_s(); }
  FrameTimer(const FrameTimer&) = delete;
  FrameTimer& operator=(const FrameTimer&) = delete;

 private:
  Timings& timings_;
  Stopwatch watch_;
};

/// Begins the timing of a frame with what was done ahead.
void begin_frame(Timings& timings, const PreparationTime& ahead) {
  timings.add("decoding", ahead.decoding);
  timings.add("image preparation", ahead.preparing);
  if (ahead.extracting.wall_s > 0) timings.add("features", ahead.extracting);
  timings.frame_ms.push_back(1e3 * ahead.preparing.wall_s);
}

bool is_prepared(const Frame& frame) {
  return !frame.gray.empty();
}

SlamOptions validated(const SlamOptions& options) {
  validate(options);
  return options;
}

}  // namespace

Slam::Slam(const RgbdCamera& camera, const SlamOptions& options)
    : Slam(camera, options, load_default_vocabulary()) {}

Slam::Slam(const RgbdCamera& camera, const SlamOptions& options, Vocabulary vocabulary)
    : camera_(camera),
      options_(validated(options)),
      sensor_estimate_(nominal_estimate(camera, options.noise)),
      keyframe_memory_(static_cast<size_t>(options_.keyframe_memory_mib) << 20),
      front_end_(sensor(), options_.features),
      tracker_(front_end_, tracker_options(options_), timings_),
      keyframes_(options_.tracking.keyframe),
      relocalizer_([this](const Frame& frame) { return relocalize(frame); }),
      mapper_(mapper_options(options_)),
      places_(sensor(), place_options(options_), std::move(vocabulary)),
      back_end_(map_, sensor_estimate_, back_end_options(options_),
                [this](const Map& map, KeyframeId keyframe) { return places_.is_aliased(keyframe, map); }),
      online_covariance_(depth_scale_sigma(camera.sensor.kind)) {}

TrackedFrame Slam::track(const Frame& frame) {
  if (!is_prepared(frame)) return track(front_end_.prepare(frame));
  if (unmapped_) update_map();
  require(session_log().empty() || frame.stamp_ns > session_log().back().stamp_ns,
          "track: frames must be in order of time");
  begin_frame(timings_, frame.time);
  const FrameTimer timer(timings_);
  apply_due_results(frame.id);

  const Frame usable = without_fixed_region(with_steady_depth(frame));
  const TrackingContext context{map_, sensor(), relocalizer_};
  TrackedFrame tracked = tracker_.track(usable, context);
  if (compensate_first(tracked)) tracked = tracker_.track(usable, context);
  add_input_evidence(tracked);
  check_location(tracked);
  if (tracked.outcome == TrackingOutcome::kRelocalized) place_.visit = map_.keyframe(tracked.reference).visit;
  // Where a map begins, the pose is that of its first keyframe.
  if (tracked.outcome == TrackingOutcome::kNewMap) tracked = with_keyframe(std::move(tracked));
  state_place(tracked);
  odometry_.update(tracked, map_);
  tracked.T_map_odom = odometry_.T_map_odom();
  tracked.world_covariance = online_covariance_.add(tracked);
  return unmapped_.emplace(std::move(tracked));
}

TrackedFrame Slam::update_map() {
  require(unmapped_.has_value(), "update_map: no frame has been tracked since the last call");
  const FrameTimer timer(timings_);
  TrackedFrame tracked = *std::exchange(unmapped_, std::nullopt);
  if (!tracked.keyframe.valid()) tracked = with_keyframe(std::move(tracked));
  if (tracked.is_repeat() && tracked.is_doubtful()) doubt_repeats();
  add_to_log(tracked);
  tracker_.update(tracked, map_);
  withdraw_contradicted();
  if (tracked.keyframe.valid()) find_loops(tracked.keyframe);
  submit_jobs(tracked.id, tracked.keyframe);
  if (!tracked.is_lost()) tracked.component = map_.keyframe(tracked.reference).component;
  return publish(std::move(tracked));
}

/// Makes the frame a keyframe if it should be one, and then tracks it by all of its keypoints.
TrackedFrame Slam::with_keyframe(TrackedFrame tracked) {
  auto selected = select_keyframe(tracked);
  if (!selected) return tracked;
  const bool rematched = selected->frame != tracked.frame;  // its keypoints show the place, patches do not
  if (rematched) check_location(*selected);
  if (may_extend_map(*selected)) insert_keyframe(*selected);
  state_place(*selected);
  return *std::move(selected);
}

/// States where the frame is in the map of this moment.
void Slam::state_place(TrackedFrame& tracked) const {
  if (tracked.is_lost()) return;
  tracked.T_world_camera = tracked.world(map_);
  tracked.component = map_.keyframe(tracked.reference).component;
  if (place_.visit) tracked.visit = *place_.visit;
}

/// Returns the frame with depth of the scale of the first frame, or without it if it is an old one.
Frame Slam::with_steady_depth(const Frame& frame) {
  const ScopedTimer timer(timings_, "depth continuity");
  const TrackedFrame* previous = tracker_.previous();
  // A repeat is one of the previous frame.
  const bool follows = previous != nullptr && tracker_.knows_velocity() && !log_.empty() &&
                       (log_.back().is_repeat() || previous->stamp_ns == log_.back().stamp_ns);
  const bool had_depth = depth_.factor() > 0;
  depth_.observe(frame, follows ? std::optional(previous->velocity) : std::nullopt);
  // That depth has stopped is seen late: the frames since then have used the depth of the one before.
  if (had_depth && depth_.factor() == 0) {
    doubt_frames_since(depth_.new_depth_ns() + 1, DoubtCause::kNoDepth);
    tracker_.forget_motion();
  }
  return depth_.factor() == 1 ? frame : front_end_.scale_depth(frame, depth_.factor());
}

/// Adds what is known of the images. Without depth for long, nothing but landmarks supports a pose.
void Slam::add_input_evidence(TrackedFrame& tracked) const {
  constexpr double kMaxWithoutDepth_s = 0.5;
  tracked.evidence.input = {fixed_region_.share(), depth_.factor()};
  if (!tracked.is_lost() && depth_.age_s() > kMaxWithoutDepth_s) doubt(tracked, DoubtCause::kNoDepth);
}

/// That the image is frozen is seen late: the repeated frames before are in doubt as well. Those before one
/// in doubt are so already.
void Slam::doubt_repeats() {
  for (size_t i = log_.size(); i-- > earlier_.frame_count && log_[i].is_repeat() && !log_[i].is_doubtful();)
    doubt(log_[i], DoubtCause::kFrozen);
}

/// The frame that starts a map is compensated for its motion when the next one tells it; true if that changes
/// the map.
bool Slam::compensate_first(const TrackedFrame& second) {
  const TrackedFrame* first = tracker_.previous();
  const bool known = second.is_located() && !second.is_repeat() && !second.is_doubtful() &&
                     first != nullptr && first->outcome == TrackingOutcome::kNewMap &&
                     !second.velocity.vector().isZero(0);
  if (!known || !needs_deskewing(*map_.keyframe(first->keyframe).features, sensor())) return false;
  mapper_.compensate_first(map_, first->keyframe, second.velocity, sensor());
  tracker_.set_first_velocity(second.velocity, second.stamp_ns - first->stamp_ns, map_);
  map_.advance_epoch();  // work in flight has the landmarks from before
  map_changed_ = true;
  return true;
}

/// Returns the frame with all of its keypoints if it should become a keyframe.
std::optional<TrackedFrame> Slam::select_keyframe(const TrackedFrame& tracked) {
  if (options_.localize_only) return std::nullopt;
  auto selected = keyframes_.select(tracked, map_, [this](const TrackedFrame& by_patches) {
    return tracker_.rematch_keypoints(by_patches, sensor());
  });
  if (selected) tracker_.find_moving(*selected, sensor());
  return selected;
}

void Slam::submit_jobs(FrameId now, KeyframeId new_keyframe) {
  const ScopedTimer timer(timings_, "back end scheduling");
  back_end_.submit(now, job_context(new_keyframe));
}

void Slam::insert_keyframe(TrackedFrame& tracked) {
  const ScopedTimer timer(timings_, "mapping");
  tracked.keyframe = mapper_.insert(map_, tracked, sensor());
  if (tracked.outcome == TrackingOutcome::kNewMap) {
    const auto& before = tracker_.trusted();
    if (before && place_.visit == map_.keyframe(before->pose.reference).visit)
      back_end_.add_beginning(tracked.keyframe, *before);
    tracked.reference = tracked.keyframe;
    place_.visit = map_.keyframe(tracked.keyframe).visit;
  } else if (place_.visit) {
    map_.set_visit(tracked.keyframe, *place_.visit);
  }
  map_.set_odometry(tracked.keyframe, online_covariance_.add_keyframe(tracked));
  places_.add(map_.keyframe(tracked.keyframe));
  keyframe_memory_.apply_limit(map_);
  map_changed_ = true;
}

void Slam::add_to_log(const TrackedFrame& tracked) {
  log_.push_back(log_entry(tracked, camera_.color.height));
  log_limiter_.apply(log_, earlier_.frame_count, frame_refinement());
}

/// Shows listeners the frame and, if it has changed, the map.
TrackedFrame Slam::publish(TrackedFrame tracked) {
  const ScopedTimer timer(timings_, "listeners");
  for (Listener* listener : listeners_) listener->on_frame(tracked);
  if (std::exchange(map_changed_, false)) {
    for (Listener* listener : listeners_) listener->on_map(map_);
  }
  return tracked;
}

void Slam::apply_due_results(FrameId now) {
  const ScopedTimer timer(timings_, "back end results");
  apply_results(back_end_.apply_due(now));
}

void Slam::apply_results(const AppliedResults& results) {
  for (const auto& [kind, elapsed] : results.elapsed) timings_.add(std::string(kind), elapsed);
  if (results.sensor) apply_sensor_estimate(*results.sensor);
  if (!results.map_changed) return;
  map_changed_ = true;
  if (results.T_world_keyframe_before.empty()) {
    tracker_.update(map_, tracker_.reference());
  } else {
    rebase_after_split(results.T_world_keyframe_before);
  }
}

/// After components were parted: expresses the poses of frames, and that of the tracker, relative to
/// keyframes of their own visit.
void Slam::rebase_after_split(const std::vector<SE3>& T_world_keyframe_before) {
  log_ = rebased_after_split(std::move(log_), map_, T_world_keyframe_before);
  tracker_.forget_trusted();  // it may be relative to a keyframe of another visit
  const KeyframeId old = tracker_.reference();
  const auto& keyframes = map_.keyframes();
  const auto own = std::find_if(keyframes.rbegin(), keyframes.rend(), [&](const Keyframe& keyframe) {
    return keyframe.visit == place_.visit && !keyframe.withdrawn;
  });
  if (!old.valid() || own == keyframes.rend() || own->component == map_.keyframe(old).component)
    return tracker_.update(map_, old);
  const SE3 T_own_old = T_world_keyframe_before[own->id.value].inverse() * T_world_keyframe_before[old.value];
  tracker_.update(map_, own->id, T_own_old);
}

/// Uses this sensor from now on, and compensates the keyframes that were added while it was estimated.
void Slam::apply_sensor_estimate(const AppliedSensor& applied) {
  sensor_estimate_ = with_fixed_from(applied.estimate, sensor_estimate_);
  const auto velocities = keyframe_velocities(log_, map_);
  for (auto i = static_cast<uint32_t>(applied.compensated_keyframes); i < velocities.size(); ++i) {
    const Features& features = *map_.keyframe(KeyframeId{i}).features;
    map_.set_features(KeyframeId{i},
                      std::make_shared<const Features>(deskew_features(features, sensor(), velocities[i])));
  }
}

void Slam::find_loops(KeyframeId keyframe) {
  if (!options_.loop.enabled) return;
  const ScopedTimer timer(timings_, "loop detection");
  back_end_.add(places_.find_loops(map_, keyframe));
}

/// States how uncertain the final poses are: by the final adjustment or, without one, by tracking.
void Slam::state_covariances() {
  const bool adjusted = !keyframe_covariance_.empty();
  auto found = pose_covariances(log_, map_, adjusted ? keyframe_covariance_ : online_covariance_.keyframes(),
                                depth_scale_sigma(camera_.sensor.kind));
  for (size_t i = 0; i < log_.size(); ++i) log_[i].world_covariance = found.frames[i];
  if (adjusted) keyframe_covariance_ = std::move(found.keyframes);
}

Trajectory Slam::finish(const Progress& progress) {
  if (unmapped_) update_map();
  apply_results(back_end_.apply_last(job_context()));
  const Stopwatch watch;
  const auto anywhere = [this](const Frame& frame) {
    auto found = relocalizer_(frame);
    // No later frame confirms it.
    if (found && (!is_confident(*found, *frame.features) || lacks_scale(*found, false)))
      doubt(*found, DoubtCause::kPlace);
    return found;
  };
  const FrameSearch search{anywhere, [this](const Frame& frame, const FrameRecord& neighbor) {
                             return places_.locate_near(frame, map_, neighbor.reference,
                                                        neighbor.T_reference_camera);
                           }};
  log_ = relocalize_lost_frames(std::move(log_), camera_.color.height, search);
  timings_.add("relocalization", watch.elapsed());
  if (options_.localize_only) {
    finish_localization();
  } else if (options_.global_ba_enabled) {
    const Stopwatch adjusting;
    auto adjusted =
        final_bundle_adjustment(map_, log_, sensor_estimate_, back_end_options(options_), progress);
    sensor_estimate_ = std::move(adjusted.sensor);
    keyframe_covariance_ = with_drift(std::move(adjusted.keyframe_covariance), map_);
    map_.advance_epoch();
    timings_.add("final bundle adjustment", adjusting.elapsed());
  }
  log_ =
      predict_unmeasured_frames(std::move(log_), earlier_.frame_count, map_, options_.max_predicted_sigma_m);
  log_ = revise_doubt(std::move(log_), earlier_.frame_count, map_);
  state_covariances();
  for (Listener* listener : listeners_) listener->on_map(map_);
  return trajectory();
}

}  // namespace kinloop
