#include "kinloop/slam/slam.hpp"

#include "kinloop/back_end/final_bundle_adjustment.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/motion_compensation.hpp"

namespace kinloop {
namespace {

/// Converts the outcome for the log and listeners. `keyframe` is valid if the frame became one.
TrackResult track_result(const TrackOutcome& outcome, KeyframeId keyframe) {
  if (const TrackResult* result = located(outcome)) return *result;
  TrackResult result;
  if (const Lost* lost = std::get_if<Lost>(&outcome)) {
    result.stats = lost->stats;
  } else {
    result.status = TrackStatus::kTracked;
    result.reference = keyframe;
  }
  return result;
}

FrameResult frame_result(const FrameTracking& tracking, const TrackResult& result, KeyframeId keyframe,
                         const Map& map) {
  FrameResult frame;
  frame.frame = tracking.frame.id;
  frame.stamp_ns = tracking.frame.stamp_ns;
  frame.status = result.status;
  frame.relocalized = std::holds_alternative<Relocalized>(tracking.outcome);
  frame.keyframe = keyframe;
  frame.reference = result.reference;
  frame.T_reference_camera = result.T_reference_camera;
  frame.matches = result.matches;
  frame.stats = result.stats;
  if (result.status == TrackStatus::kLost) return frame;
  frame.T_world_camera = map.keyframe(result.reference).T_world_camera * result.T_reference_camera;
  return frame;
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
      sensor_estimate_(nominal_estimate(make_sensor(camera, options.noise))),
      keyframe_memory_(static_cast<size_t>(options_.keyframe_memory_mib) << 20),
      front_end_(sensor(), options_.features),
      tracker_(sensor(), tracker_options(options_)),
      mapper_(mapper_options(options_)),
      places_(sensor(), place_options(options_), std::move(vocabulary)),
      back_end_(map_, sensor(), back_end_options(options_)) {}

FrameResult Slam::process(const PreparedFrame& measured) {
  require(session_log().empty() || measured.stamp_ns > session_log().back().stamp_ns,
          "process: frames must be in order of time");
  const Stopwatch watch;
  timings_.add("decoding", measured.decoding);
  timings_.add("image preparation", measured.preparing);
  if (measured.features) timings_.add("features", measured.extracting);
  Stopwatch module;
  apply_results(back_end_.apply_due(measured.id));
  back_end_.submit(measured.id, job_context());
  timings_.add("back end scheduling", module.lap());

  const Relocalizer relocalize = [this](const PreparedFrame& frame) {
    return places_.relocalize(frame, map_);
  };
  const TrackingContext context{map_, sensor(), relocalize};
  FrameTracking tracking = tracker_.track(measured, context, timings_);
  module.lap();
  bool needs_keyframe = tracking.has_keypoints && mapper_.needs_keyframe(map_, tracking);
  if (!tracking.has_keypoints && mapper_.may_need_keyframe(map_, tracking)) {
    FrameTracking all = tracker_.with_keypoints(tracking, context, timings_);
    module.lap();
    needs_keyframe = mapper_.needs_keyframe(map_, all);
    if (needs_keyframe) tracking = std::move(all);
  }
  KeyframeId keyframe;
  if (needs_keyframe) keyframe = insert_keyframe(tracking);
  const TrackResult result = track_result(tracking.outcome, keyframe);
  log_.push_back(make_log_entry(result, tracking.frame, camera_.color.height));
  log_.back().repeat = tracking.repeat;
  log_.back().keyframe = keyframe;
  log_limiter_.apply(log_, earlier_.frame_count, frame_refinement());
  timings_.add("mapping", module.lap());

  if (keyframe.valid()) {
    tracker_.update(map_, keyframe, &tracking);
    timings_.add("local map", module.lap());
    find_loops(keyframe);
    timings_.add("loop detection", module.lap());
    back_end_.submit(measured.id, job_context(keyframe));
    timings_.add("back end scheduling", module.lap());
  } else {
    tracker_.update(map_, best_reference(map_, result.matches, tracker_.reference()), &tracking);
    timings_.add("local map", module.lap());
  }
  timings_.frame_ms.push_back(1e3 * (watch.wall_s() + measured.preparing.wall_s));
  FrameResult done = frame_result(tracking, result, keyframe, map_);
  module.lap();
  notify_listeners(done, tracking.frame);
  timings_.add("listeners", module.lap());
  return done;
}

void Slam::apply_results(const AppliedResults& results) {
  for (const auto& [kind, elapsed] : results.elapsed) timings_.add(std::string(kind), elapsed);
  if (results.sensor) apply_sensor_estimate(*results.sensor);
  if (!results.map_changed) return;
  map_changed_ = true;
  tracker_.update(map_, tracker_.reference());
}

/// Uses this sensor from now on and updates the keyframes.
void Slam::apply_sensor_estimate(const SensorEstimate& estimate) {
  sensor_estimate_ = with_fixed_from(estimate, sensor_estimate_);
  const auto velocities = keyframe_velocities(log_, map_);
  for (uint32_t i = 0; i < velocities.size(); ++i) {
    const Features& features = *map_.keyframe(KeyframeId{i}).features;
    map_.set_features(KeyframeId{i},
                      std::make_shared<const Features>(deskew_features(features, sensor(), velocities[i])));
  }
}

KeyframeId Slam::insert_keyframe(const FrameTracking& tracking) {
  const KeyframeId id = mapper_.insert_keyframe(map_, tracking, sensor());
  places_.add(map_.keyframe(id));
  keyframe_memory_.apply_limit(map_);
  map_changed_ = true;
  return id;
}

void Slam::find_loops(KeyframeId keyframe) {
  if (!options_.loop.enabled) return;
  back_end_.add_loop_candidates(places_.find_loops(map_, keyframe));
}

Trajectory Slam::finish(const Progress& progress) {
  apply_results(back_end_.apply_remaining(job_context()));
  const Stopwatch watch;
  const FrameSearch search{[this](const PreparedFrame& frame) { return places_.relocalize(frame, map_); },
                           [this](const PreparedFrame& frame, const LoggedFrame& neighbor) {
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
    keyframe_covariance_ = std::move(adjusted.keyframe_covariance);
    map_.advance_epoch();
    timings_.add("final bundle adjustment", adjusting.elapsed());
  }
  for (Listener* listener : listeners_) listener->on_map(map_);
  return trajectory();
}

void Slam::notify_listeners(const FrameResult& result, const PreparedFrame& frame) {
  for (Listener* listener : listeners_) listener->on_frame(result, frame);
  if (!map_changed_) return;
  for (Listener* listener : listeners_) listener->on_map(map_);
  map_changed_ = false;
}

}  // namespace kinloop
