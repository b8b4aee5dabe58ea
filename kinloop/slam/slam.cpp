#include "kinloop/slam/slam.hpp"

#include <opencv2/imgproc.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/random.hpp"
#include "kinloop/features/extractor.hpp"
#include "kinloop/loop/relocalize.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/slam/final_adjustment.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/still_features.hpp"

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
    : camera_(camera), options_(options), vocabulary_(std::move(vocabulary)), work_(camera, options) {
  sensor_.value = known_sensor(camera);
}

Slam::~Slam() = default;

BowVector Slam::bow_of(const Features& features) const {
  return vocabulary_.bow_of(vocabulary_.words_of(features.descriptors).words);
}

PreparedFrame Slam::prepare(const RgbdFrame& frame) const {
  const cv::Size size(camera_.color.width, camera_.color.height);
  require(frame.color.type() == CV_8UC3 && frame.color.size() == size,
          "prepare: colour must be BGR of the camera's size");
  require(frame.depth_m.type() == CV_32FC1 && frame.depth_m.size() == size,
          "prepare: depth must be float metres of the camera's size");
  const Stopwatch watch;
  PreparedFrame prepared;
  prepared.id = FrameId{first_frame_ + frame.id.value};
  prepared.stamp_ns = frame.stamp_ns;
  prepared.color = frame.color;
  prepared.depth_m = frame.depth_m;
  cv::cvtColor(frame.color, prepared.gray, cv::COLOR_BGR2GRAY);
  prepared.features = std::make_shared<const Features>(
      extract_features(prepared.gray, prepared.depth_m, camera_.color, options_.features));
  prepared.preparing = watch.spent();
  return prepared;
}

FrameResult Slam::process(const PreparedFrame& measured) {
  const Stopwatch watch;
  times_.add("features", measured.preparing);
  take_in(work_.apply_due(map_, measured.id));

  FrameResult told{measured.id, measured.stamp_ns, TrackStatus::kLost, false, {}, {}, {}, {}, {}, {}};
  const bool repeat = repeats_previous(measured);
  TrackResult result = repeat ? previous_result() : locate(at_rest(measured), told.relocalized);
  if (options_.localize_only && !on_map(result, measured)) result.matches.clear();
  PreparedFrame frame = measured;
  if (!repeat) {
    learn_motion(measured, result);
    frame = at_rest(measured);  // now that its own motion is known
    remember(frame, result);
  }
  log_.push_back(log_entry(result, measured, camera_.color.height));
  log_.back().repeat = repeat;
  if (!repeat && !options_.localize_only && wants_keyframe(frame, result)) {
    told.keyframe = insert_keyframe(frame, result);
  } else if (result.status != TrackStatus::kLost) {
    const KeyframeId best = best_reference(map_, result.matches, view_.reference);
    if (best != view_.reference) look_from(best);
  }
  told.status = result.status;
  told.stats = result.stats;
  told.reference = result.reference;
  told.T_reference_camera = result.T_reference_camera;
  told.matches = result.matches;
  if (result.status != TrackStatus::kLost) {
    told.T_world_camera = map_.keyframe(result.reference).T_world_camera * result.T_reference_camera;
  }
  times_.frame_ms.push_back(1e3 * (watch.wall_s() + frame.preparing.wall_s));
  tell(told, frame);
  return told;
}

void Slam::take_in(const AppliedWork& work) {
  for (const auto& [kind, spent] : work.spent) times_.add(name_of(kind), spent);
  if (work.sensor) take_sensor(*work.sensor);
  if (!work.map_changed) return;
  map_changed_ = true;
  if (view_.reference.valid()) view_ = make_local_view(map_, view_.reference, options_.view);
}

/// The frame as an ideal camera at rest would have taken it, going by how the camera moves now.
PreparedFrame Slam::at_rest(const PreparedFrame& frame) const {
  PreparedFrame still = frame;
  if (!sensor_.value.isZero(0)) {
    still.features = std::make_shared<const Features>(
        still_features(*frame.features, camera_.color, sensor_.value, motion_.velocity()));
  }
  return still;
}

/// From now on the sensor is taken to be like this; keyframes follow.
void Slam::take_sensor(const SensorEstimate& sensor) {
  sensor_ = with_held_from(sensor, sensor_);
  const auto velocities = keyframe_velocities(log_, map_);
  for (uint32_t i = 0; i < velocities.size(); ++i) {
    const Features& features = *map_.keyframe(KeyframeId{i}).features;
    map_.set_features(KeyframeId{i}, std::make_shared<const Features>(still_features(
                                         features, camera_.color, sensor_.value, velocities[i])));
  }
}

/// The first keyframe of the map, or of a new component of it.
TrackResult Slam::start(const PreparedFrame& frame) {
  TrackResult result;
  if (count_with_depth(*frame.features) < options_.min_start_points) return result;
  result.status = TrackStatus::kTracked;
  result.reference = next_keyframe();
  previous_.reset();
  view_ = {};
  return result;
}

/// Drivers fill the gap of a lost image with the one before: the camera has moved on, its picture has not.
bool Slam::repeats_previous(const PreparedFrame& frame) const {
  if (!previous_ || after_loss()) return false;
  const cv::Mat& a = previous_->frame.gray;
  const cv::Mat& b = frame.gray;
  return !a.empty() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TrackResult Slam::previous_result() const {
  TrackResult result;
  result.status = TrackStatus::kTracked;
  result.reference = view_.reference;
  result.T_reference_camera = previous_->T_reference_camera;
  for (uint32_t i = 0; i < previous_->landmark_of.size(); ++i) {
    if (previous_->landmark_of[i].valid()) result.matches.push_back({previous_->landmark_of[i], i});
  }
  result.stats.inliers = static_cast<int>(result.matches.size());
  return result;
}

TrackResult Slam::locate(const PreparedFrame& frame, bool& relocalized) {
  if (map_.keyframes().empty()) return options_.localize_only ? TrackResult{} : start(frame);
  const Stopwatch watch;
  TrackResult result;
  if (previous_) {
    PredictedPose predicted = motion_.predict(frame.stamp_ns - previous_->frame.stamp_ns);
    predicted.T = previous_->T_reference_camera * predicted.T;
    result = track(frame, *previous_, view_, predicted, camera_.color, options_.tracking, seed_of(frame.id));
  }
  times_.add("tracking", watch.spent());
  // Depth images alone tell the motion from one frame to the next, not across a gap.
  if (after_loss() && result.status == TrackStatus::kDenseOnly) result = {};
  const bool as_predicted = result.stats.tries == 1 && (!options_.localize_only || on_map(result, frame));
  if (result.status == TrackStatus::kTracked && as_predicted) return result;

  // Where the camera is not where it was going, it may have been carried elsewhere: what the map says counts
  // more than a handful of chance matches.
  const Stopwatch relocalization_watch;
  const auto found = look_up(frame);
  times_.add("relocalisation", relocalization_watch.spent());
  if (!found || found->stats.inliers <= result.stats.inliers) {
    const bool give_up = result.status == TrackStatus::kLost && lost_for_long() && !options_.localize_only;
    return give_up ? start(frame) : result;
  }
  relocalized = true;
  previous_.reset();
  view_ = make_local_view(map_, found->reference, options_.view);
  return *found;
}

/// Asks the place index.
std::optional<TrackResult> Slam::look_up(const PreparedFrame& frame) const {
  return relocalize(frame, bow_of(*frame.features), map_, places_, camera_.color, options_.view,
                    options_.loop, options_.tracking, seed_of(frame.id));
}

/// Whether the frames before this one were lost for so long that the camera may be where it has never been.
bool Slam::lost_for_long() const {
  const auto patience = static_cast<size_t>(options_.lost_frames_before_component);
  const auto log = session_log();
  const auto lost = [](const LoggedFrame& entry) { return entry.status == TrackStatus::kLost; };
  return patience > 0 && log.size() >= patience &&
         std::all_of(log.end() - static_cast<long>(patience), log.end(), lost);
}

void Slam::learn_motion(const PreparedFrame& frame, const TrackResult& result) {
  if (previous_ && !after_loss() && result.status != TrackStatus::kLost) {
    motion_.update(previous_->T_reference_camera.inverse() * result.T_reference_camera,
                   frame.stamp_ns - previous_->frame.stamp_ns);
  } else {
    motion_.reset();
  }
}

/// Keeps what the next frame needs; after a loss that is the last frame whose place is known.
void Slam::remember(const PreparedFrame& frame, const TrackResult& result) {
  ++frames_since_keyframe_;
  if (result.status == TrackStatus::kLost) return;
  previous_ = TrackedFrame{frame, result.T_reference_camera, std::vector<LandmarkId>(frame.features->size())};
  for (const LandmarkMatch& match : result.matches) previous_->landmark_of[match.feature] = match.landmark;
}

/// Makes `reference` the keyframe of the local view and carries the previous frame's pose over to it.
void Slam::look_from(KeyframeId reference) {
  if (previous_ && view_.reference.valid()) {
    previous_->T_reference_camera = map_.keyframe(reference).T_world_camera.inverse() *
                                    map_.keyframe(view_.reference).T_world_camera *
                                    previous_->T_reference_camera;
  }
  view_ = make_local_view(map_, reference, options_.view);
}

Trajectory Slam::finish(const Progress& progress) {
  take_in(work_.apply_rest(map_));
  const Stopwatch watch;
  log_ = find_lost_frames(std::move(log_), camera_.color.height,
                          [this](const PreparedFrame& frame) { return look_up(frame); });
  times_.add("relocalisation", watch.spent());
  if (options_.localize_only) {
    finish_localizing();
  } else if (options_.full_adjustment) {
    const Stopwatch adjusting;
    auto adjusted = adjust_finally(map_, log_, camera_, sensor_, options_, progress);
    sensor_ = std::move(adjusted.sensor);
    keyframe_covariance_ = std::move(adjusted.keyframe_covariance);
    map_.raise_epoch();
    times_.add("final adjustment", adjusting.spent());
  }
  for (Listener* listener : listeners_) listener->on_map(map_);
  return trajectory();
}

void Slam::tell(const FrameResult& result, const PreparedFrame& frame) {
  for (Listener* listener : listeners_) listener->on_frame(result, frame);
  if (!map_changed_) return;
  for (Listener* listener : listeners_) listener->on_map(map_);
  map_changed_ = false;
}

uint64_t Slam::seed_of(FrameId frame) const {
  return hash(static_cast<uint64_t>(options_.seed), frame.value);
}

}  // namespace kinloop
