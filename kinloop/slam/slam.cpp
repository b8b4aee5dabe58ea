#include "kinloop/slam/slam.hpp"

#include <opencv2/imgproc.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/random.hpp"
#include "kinloop/features/extractor.hpp"
#include "kinloop/loop/relocalize.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/slam/final_bundle_adjustment.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/motion_compensation.hpp"

namespace kinloop {
namespace {

int count_with_depth(const Features& features) {
  return static_cast<int>(std::count_if(features.depths_m.begin(), features.depths_m.end(),
                                        [](float depth_m) { return depth_m > 0; }));
}

}  // namespace

Slam::Slam(const RgbdCamera& camera, const SlamOptions& options)
    : Slam(camera, options, load_default_vocabulary()) {}

Slam::Slam(const RgbdCamera& camera, const SlamOptions& options, Vocabulary vocabulary)
    : camera_(camera), options_(options), vocabulary_(std::move(vocabulary)), back_end_(camera, options) {
  sensor_.value = nominal_sensor(camera);
}

Slam::~Slam() = default;

BowVector Slam::bow_of(const Features& features) const {
  return vocabulary_.bow_of(vocabulary_.quantize(features.descriptors).words);
}

PreparedFrame Slam::prepare(const RgbdFrame& frame) const {
  const cv::Size size(camera_.color.width, camera_.color.height);
  require(frame.color.type() == CV_8UC3 && frame.color.size() == size,
          "prepare: color image must be 8UC3 BGR of the camera's size");
  require(frame.depth_m.type() == CV_32FC1 && frame.depth_m.size() == size,
          "prepare: depth image must be 32FC1 in metres, of the camera's size");
  const Stopwatch watch;
  PreparedFrame prepared;
  prepared.id = FrameId{first_frame_ + frame.id.value};
  prepared.stamp_ns = frame.stamp_ns;
  prepared.color = frame.color;
  prepared.depth_m = frame.depth_m;
  cv::cvtColor(frame.color, prepared.gray, cv::COLOR_BGR2GRAY);
  prepared.features = std::make_shared<const Features>(
      extract_features(prepared.gray, prepared.depth_m, camera_.color, options_.features));
  prepared.preparing = watch.elapsed();
  return prepared;
}

FrameResult Slam::process(const PreparedFrame& measured) {
  const Stopwatch watch;
  timings_.add("features", measured.preparing);
  apply_results(back_end_.apply_due(map_, measured.id));

  FrameResult frame_result{measured.id, measured.stamp_ns, TrackStatus::kLost, false, {}, {}, {}, {}, {}, {}};
  const bool repeat = repeats_previous_image(measured);
  TrackResult result = repeat ? previous_result()
                              : track_or_relocalize(motion_compensated(measured), frame_result.relocalized);
  if (options_.localize_only && !is_localized(result, measured)) result.matches.clear();
  PreparedFrame frame = measured;
  if (!repeat) {
    update_motion_model(measured, result);
    frame = motion_compensated(measured);  // now that its own motion is known
    store_previous_frame(frame, result);
  }
  log_.push_back(make_log_entry(result, measured, camera_.color.height));
  log_.back().repeat = repeat;
  if (!repeat && !options_.localize_only && should_insert_keyframe(frame, result)) {
    frame_result.keyframe = insert_keyframe(frame, result);
  } else if (result.status != TrackStatus::kLost) {
    const KeyframeId best = best_reference(map_, result.matches, local_map_.reference);
    if (best != local_map_.reference) set_reference_keyframe(best);
  }
  frame_result.status = result.status;
  frame_result.stats = result.stats;
  frame_result.reference = result.reference;
  frame_result.T_reference_camera = result.T_reference_camera;
  frame_result.matches = result.matches;
  if (result.status != TrackStatus::kLost) {
    frame_result.T_world_camera = map_.keyframe(result.reference).T_world_camera * result.T_reference_camera;
  }
  timings_.frame_ms.push_back(1e3 * (watch.wall_s() + frame.preparing.wall_s));
  notify_listeners(frame_result, frame);
  return frame_result;
}

void Slam::apply_results(const AppliedResults& work) {
  for (const auto& [kind, elapsed] : work.elapsed) timings_.add(to_string(kind), elapsed);
  if (work.sensor) apply_sensor_estimate(*work.sensor);
  if (!work.map_changed) return;
  map_changed_ = true;
  if (local_map_.reference.valid())
    local_map_ = make_local_map(map_, local_map_.reference, options_.local_map);
}

/// The frame as an ideal camera at rest would have taken it, going by how the camera moves now.
PreparedFrame Slam::motion_compensated(const PreparedFrame& frame) const {
  PreparedFrame compensated = frame;
  if (!sensor_.value.isZero(0)) {
    compensated.features = std::make_shared<const Features>(
        deskew_features(*frame.features, camera_.color, sensor_.value, motion_.velocity()));
  }
  return compensated;
}

/// From now on the sensor is taken to be like this; keyframes follow.
void Slam::apply_sensor_estimate(const SensorEstimate& sensor) {
  sensor_ = with_fixed_from(sensor, sensor_);
  const auto velocities = keyframe_velocities(log_, map_);
  for (uint32_t i = 0; i < velocities.size(); ++i) {
    const Features& features = *map_.keyframe(KeyframeId{i}).features;
    map_.set_features(KeyframeId{i}, std::make_shared<const Features>(deskew_features(
                                         features, camera_.color, sensor_.value, velocities[i])));
  }
}

/// The first keyframe of the map, or of a new component of it.
TrackResult Slam::initialize_map(const PreparedFrame& frame) {
  TrackResult result;
  if (count_with_depth(*frame.features) < options_.min_initial_keypoints) return result;
  result.status = TrackStatus::kTracked;
  result.reference = next_keyframe_id();
  previous_.reset();
  local_map_ = {};
  return result;
}

/// Drivers fill the gap of a lost image with the one before: the camera has moved on, its picture has not.
bool Slam::repeats_previous_image(const PreparedFrame& frame) const {
  if (!previous_ || previous_frame_lost()) return false;
  const cv::Mat& a = previous_->frame.gray;
  const cv::Mat& b = frame.gray;
  return !a.empty() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TrackResult Slam::previous_result() const {
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

TrackResult Slam::track_or_relocalize(const PreparedFrame& frame, bool& relocalized) {
  if (map_.keyframes().empty()) return options_.localize_only ? TrackResult{} : initialize_map(frame);
  const Stopwatch watch;
  TrackResult result;
  if (previous_) {
    PredictedPose predicted = motion_.predict(frame.stamp_ns - previous_->frame.stamp_ns);
    predicted.T = previous_->T_reference_camera * predicted.T;
    result =
        track(frame, *previous_, local_map_, predicted, camera_.color, options_.tracking, seed_of(frame.id));
  }
  timings_.add("tracking", watch.elapsed());
  // Depth images alone tell the motion from one frame to the next, not across a gap.
  if (previous_frame_lost() && result.status == TrackStatus::kDenseOnly) result = {};
  const bool as_predicted =
      result.stats.attempts == 1 && (!options_.localize_only || is_localized(result, frame));
  if (result.status == TrackStatus::kTracked && as_predicted) return result;

  // Where the camera is not where it was going, it may have been carried elsewhere: what the map says counts
  // more than a handful of chance matches.
  const Stopwatch relocalization_watch;
  const auto found = relocalize(frame);
  timings_.add("relocalization", relocalization_watch.elapsed());
  if (!found || found->stats.inliers <= result.stats.inliers) {
    const bool give_up =
        result.status == TrackStatus::kLost && should_start_component() && !options_.localize_only;
    return give_up ? initialize_map(frame) : result;
  }
  relocalized = true;
  previous_.reset();
  local_map_ = make_local_map(map_, found->reference, options_.local_map);
  return *found;
}

/// Asks the place index.
std::optional<TrackResult> Slam::relocalize(const PreparedFrame& frame) const {
  return kinloop::relocalize(frame, bow_of(*frame.features), map_, places_, camera_.color, options_.local_map,
                             options_.loop, options_.tracking, seed_of(frame.id));
}

/// Whether the frames before this one were lost for so long that the camera may be where it has never been.
bool Slam::should_start_component() const {
  const auto min_lost_frames = static_cast<size_t>(options_.lost_frames_before_new_component);
  const auto log = session_log();
  const auto lost = [](const LoggedFrame& entry) { return entry.status == TrackStatus::kLost; };
  return min_lost_frames > 0 && log.size() >= min_lost_frames &&
         std::all_of(log.end() - static_cast<long>(min_lost_frames), log.end(), lost);
}

void Slam::update_motion_model(const PreparedFrame& frame, const TrackResult& result) {
  if (previous_ && !previous_frame_lost() && result.status != TrackStatus::kLost) {
    motion_.update(previous_->T_reference_camera.inverse() * result.T_reference_camera,
                   frame.stamp_ns - previous_->frame.stamp_ns);
  } else {
    motion_.reset();
  }
}

/// Keeps what the next frame needs; after a loss that is the last frame whose place is known.
void Slam::store_previous_frame(const PreparedFrame& frame, const TrackResult& result) {
  ++frames_since_keyframe_;
  if (result.status == TrackStatus::kLost) return;
  previous_ = TrackedFrame{frame, result.T_reference_camera, std::vector<LandmarkId>(frame.features->size())};
  for (const LandmarkMatch& match : result.matches) previous_->landmark_of[match.feature] = match.landmark;
}

/// Makes `reference` the keyframe of the local map and carries the previous frame's pose over to it.
void Slam::set_reference_keyframe(KeyframeId reference) {
  if (previous_ && local_map_.reference.valid()) {
    previous_->T_reference_camera = map_.keyframe(reference).T_world_camera.inverse() *
                                    map_.keyframe(local_map_.reference).T_world_camera *
                                    previous_->T_reference_camera;
  }
  local_map_ = make_local_map(map_, reference, options_.local_map);
}

Trajectory Slam::finish(const Progress& progress) {
  apply_results(back_end_.apply_remaining(map_));
  const Stopwatch watch;
  log_ = relocalize_lost_frames(std::move(log_), camera_.color.height,
                                [this](const PreparedFrame& frame) { return relocalize(frame); });
  timings_.add("relocalization", watch.elapsed());
  if (options_.localize_only) {
    finish_localization();
  } else if (options_.global_ba_enabled) {
    const Stopwatch adjusting;
    auto adjusted = final_bundle_adjustment(map_, log_, camera_, sensor_, options_, progress);
    sensor_ = std::move(adjusted.sensor);
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

uint64_t Slam::seed_of(FrameId frame) const {
  return hash(static_cast<uint64_t>(options_.seed), frame.value);
}

}  // namespace kinloop
