#include "kinloop/slam/slam.hpp"

#include <opencv2/imgproc.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/random.hpp"
#include "kinloop/features/extractor.hpp"
#include "kinloop/loop/close_loop.hpp"
#include "kinloop/loop/relocalize.hpp"
#include "kinloop/mapping/grow.hpp"
#include "kinloop/mapping/local_adjustment.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/slam/final_adjustment.hpp"
#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/still_features.hpp"

namespace kinloop {
namespace {

BowVector bow_of(const Vocabulary& vocabulary, const Features& features) {
  return vocabulary.bow_of(vocabulary.words_of(features.descriptors).words);
}

int count_with_depth(const Features& features) {
  return static_cast<int>(std::count_if(features.depths_m.begin(), features.depths_m.end(),
                                        [](float depth_m) { return depth_m > 0; }));
}

/// Landmarks of a keyframe that at least one other keyframe confirms.
int confirmed_landmarks(const Map& map, KeyframeId id) {
  int count = 0;
  for (const LandmarkId landmark : map.keyframe(id).landmark_of) {
    count += landmark.valid() && map.landmark(landmark).observations.size() >= 2 ? 1 : 0;
  }
  return count;
}

/// The keyframe that shares most of the matched landmarks; the lower id of equals, `fallback` where none
/// does.
KeyframeId best_reference(const Map& map, const std::vector<LandmarkMatch>& matches, KeyframeId fallback) {
  std::vector<int> shared(map.keyframes().size(), 0);
  for (const LandmarkMatch& match : matches) {
    if (!map.contains(match.landmark)) continue;
    for (const auto& observation : map.landmark(match.landmark).observations)
      ++shared[observation.keyframe.value];
  }
  const auto most = std::max_element(shared.begin(), shared.end());
  if (most == shared.end() || *most == 0) return fallback;
  return KeyframeId{static_cast<uint32_t>(most - shared.begin())};
}

}  // namespace

Slam::Slam(const RgbdCamera& camera, const SlamOptions& options)
    : Slam(camera, options, load_default_vocabulary()) {}

Slam::Slam(const RgbdCamera& camera, const SlamOptions& options, Vocabulary vocabulary)
    : camera_(camera),
      options_(options),
      vocabulary_(std::move(vocabulary)),
      executor_(make_executor(options.executor)),
      keyframes_to_calibrate_(static_cast<size_t>(options.self_calibration.first_keyframes)) {}

Slam::~Slam() = default;

PreparedFrame Slam::prepare(const RgbdFrame& frame) const {
  const cv::Size size(camera_.color.width, camera_.color.height);
  require(frame.color.type() == CV_8UC3 && frame.color.size() == size,
          "prepare: colour must be BGR of the camera's size");
  require(frame.depth_m.type() == CV_32FC1 && frame.depth_m.size() == size,
          "prepare: depth must be float metres of the camera's size");
  const Stopwatch watch;
  PreparedFrame prepared;
  prepared.id = frame.id;
  prepared.stamp_ns = frame.stamp_ns;
  prepared.color = frame.color;
  prepared.depth_m = frame.depth_m;
  cv::cvtColor(frame.color, prepared.gray, cv::COLOR_BGR2GRAY);
  prepared.features = std::make_shared<const Features>(
      extract_features(prepared.gray, prepared.depth_m, camera_.color, options_.features));
  prepared.prepare_wall_s = watch.wall_s();
  prepared.prepare_cpu_s = watch.cpu_s();
  return prepared;
}

FrameResult Slam::process(const PreparedFrame& measured) {
  const Stopwatch watch;
  times_.add("features", measured.prepare_wall_s, measured.prepare_cpu_s);
  now_ = measured.id;
  apply_finished_work(executor_->collect(now_));

  PreparedFrame frame = at_rest(measured);
  FrameResult told{frame.id, frame.stamp_ns, TrackStatus::kLost, false, {}, {}, {}};
  const bool repeat = repeats_previous(measured);
  const TrackResult result = map_.keyframes().empty() ? start(frame)
                             : repeat                 ? previous_result()
                                                      : locate(frame, told.relocalized);
  if (!repeat) {
    learn_motion(frame, result);
    frame = at_rest(measured);  // now that its own motion is known
    remember(frame, result);
  }
  log_.push_back(log_entry(result, measured, camera_.color.height));
  log_.back().repeat = repeat;
  if (!repeat && wants_keyframe(frame, result)) {
    told.keyframe = insert_keyframe(frame, result);
  } else if (result.status != TrackStatus::kLost) {
    const KeyframeId best = best_reference(map_, result.matches, view_.reference);
    if (best != view_.reference) look_from(best);
  }
  told.status = result.status;
  told.stats = result.stats;
  if (result.status != TrackStatus::kLost) {
    told.T_world_camera = map_.keyframe(result.reference).T_world_camera * result.T_reference_camera;
  }
  times_.frame_ms.push_back(1e3 * (watch.wall_s() + frame.prepare_wall_s));
  tell(told, frame);
  return told;
}

void Slam::apply_finished_work(const std::vector<FinishedJob>& jobs) {
  for (const FinishedJob& job : jobs) {
    if (!map_.apply(job.result.update)) continue;
    map_changed_ = true;
    if (job.kind != JobKind::kLocalAdjustment) map_.raise_epoch();
    if (job.result.sensor) take_sensor(*job.result.sensor);
    if (job.kind == JobKind::kLoopCorrection) full_adjustment_pending_ = true;
  }
  if (!jobs.empty() && view_.reference.valid()) view_ = make_local_view(map_, view_.reference, options_.view);
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
  sensor_ = sensor;
  const auto velocities = keyframe_velocities(log_, map_);
  for (uint32_t i = 0; i < velocities.size(); ++i) {
    const Features& features = *map_.keyframe(KeyframeId{i}).features;
    map_.set_features(KeyframeId{i}, std::make_shared<const Features>(still_features(
                                         features, camera_.color, sensor_.value, velocities[i])));
  }
}

/// The first keyframe of the map: the world begins at its camera.
TrackResult Slam::start(const PreparedFrame& frame) {
  TrackResult result;
  if (count_with_depth(*frame.features) < options_.min_start_points) return result;
  result.status = TrackStatus::kTracked;
  result.reference = KeyframeId{0};
  return result;
}

/// Drivers fill the gap of a lost image with the one before: the camera has moved on, its picture has not.
bool Slam::repeats_previous(const PreparedFrame& frame) const {
  if (!previous_) return false;
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
  const Stopwatch watch;
  TrackResult result;
  if (previous_) {
    const SE3 T_previous_camera = motion_.predict(frame.stamp_ns - previous_->frame.stamp_ns);
    result = track(frame, *previous_, view_, previous_->T_reference_camera * T_previous_camera, camera_.color,
                   options_.tracking, seed_of(frame.id));
  }
  times_.add("tracking", watch);
  if (result.status != TrackStatus::kLost) return result;

  const Stopwatch relocalization_watch;
  const auto found = relocalize(frame, bow_of(vocabulary_, *frame.features), map_, places_, camera_.color,
                                options_.view, options_.loop, options_.tracking, seed_of(frame.id));
  times_.add("relocalisation", relocalization_watch);
  if (!found) return result;
  relocalized = true;
  previous_.reset();
  view_ = make_local_view(map_, found->reference, options_.view);
  return *found;
}

void Slam::learn_motion(const PreparedFrame& frame, const TrackResult& result) {
  if (previous_ && result.status != TrackStatus::kLost) {
    motion_.update(previous_->T_reference_camera.inverse() * result.T_reference_camera,
                   frame.stamp_ns - previous_->frame.stamp_ns);
  } else {
    motion_.reset();
  }
}

/// Keeps what the next frame needs, and what the trajectory needs.
void Slam::remember(const PreparedFrame& frame, const TrackResult& result) {
  ++frames_since_keyframe_;
  if (result.status == TrackStatus::kLost) {
    previous_.reset();
    return;
  }
  previous_ = TrackedFrame{frame, result.T_reference_camera, std::vector<LandmarkId>(frame.features->size())};
  for (const LandmarkMatch& match : result.matches) previous_->landmark_of[match.feature] = match.landmark;
}

bool Slam::wants_keyframe(const PreparedFrame& frame, const TrackResult& result) const {
  if (map_.keyframes().empty()) return result.status != TrackStatus::kLost;
  if (result.status == TrackStatus::kLost) return false;
  const SE3 T_last_keyframe_camera = map_.keyframe(last_keyframe_).T_world_camera.inverse() *
                                     map_.keyframe(result.reference).T_world_camera *
                                     result.T_reference_camera;
  const KeyframeQuestion question{result, frame, T_last_keyframe_camera, frames_since_keyframe_,
                                  confirmed_landmarks(map_, view_.reference)};
  return needs_keyframe(question, options_.tracking.keyframe);
}

KeyframeId Slam::insert_keyframe(const PreparedFrame& frame, const TrackResult& result) {
  const Stopwatch watch;
  const SE3 T_world_camera = map_.keyframes().empty()
                                 ? SE3{}
                                 : map_.keyframe(result.reference).T_world_camera * result.T_reference_camera;
  const KeyframeId id = map_.add_keyframe(frame.id, frame.stamp_ns, T_world_camera, frame.features);
  observe_matches(map_, id, result.matches);
  attach_landmarks(map_, id, make_local_view(map_, id, options_.view), camera_.color, options_.mapping);
  grow_from_depth(map_, id, camera_.color, options_.mapping);
  cull_landmarks(map_, options_.mapping);
  places_.add(id, bow_of(vocabulary_, *frame.features));
  times_.add("mapping", watch);

  log_.back().keyframe = id;
  last_keyframe_ = id;
  frames_since_keyframe_ = 0;
  map_changed_ = true;
  look_from(id);
  look_for_loops(id);
  submit_adjustments(id);
  return id;
}

void Slam::look_for_loops(KeyframeId id) {
  if (!options_.loop.enabled) return;
  const Stopwatch watch;
  auto candidates = find_loop_candidates(map_, places_, id, loop_history_, options_.loop);
  loop_history_ = std::move(candidates.history);
  const auto closure = verify_loop(map_, id, candidates.keyframes, camera_.color, options_.view,
                                   options_.loop, options_.tracking, seed_of(map_.keyframe(id).frame));
  if (closure) {
    map_.add_loop_edge(closure->edge);
    pending_merges_.insert(pending_merges_.end(), closure->merges.begin(), closure->merges.end());
    loop_pending_ = true;
  }
  times_.add("loop", watch);
}

/// Copies the problems that are due and hands them in; one of a kind at a time.
void Slam::submit_adjustments(KeyframeId newest) {
  const Stopwatch watch;
  const bool bending = executor_->busy(JobKind::kLoopCorrection) || executor_->busy(JobKind::kFullAdjustment);
  if (loop_pending_ && !bending) {
    auto problem = loop_problem(map_, std::move(pending_merges_), options_.loop);
    executor_->submit(
        JobKind::kLoopCorrection, now_,
        [problem = std::move(problem), options = options_.loop] { return correct_loop(problem, options); });
    pending_merges_.clear();
    loop_pending_ = false;
  } else if (full_adjustment_pending_ && options_.full_adjustment && !bending) {
    executor_->submit(JobKind::kFullAdjustment, now_,
                      [problem = full_problem(map_, camera_.color), options = options_.full] {
                        return adjust(problem, options);
                      });
    full_adjustment_pending_ = false;
  }
  if (options_.mapping.local_adjustment && newest.value > 0 && !executor_->busy(JobKind::kLocalAdjustment)) {
    executor_->submit(JobKind::kLocalAdjustment, now_,
                      [problem = local_problem(map_, newest, camera_.color, options_.mapping),
                       options = options_.mapping.bundle] { return adjust(problem, options); });
  }
  if (options_.self_calibration.enabled && !bending && map_.keyframes().size() >= keyframes_to_calibrate_ &&
      !executor_->busy(JobKind::kSelfCalibration)) {
    executor_->submit(
        JobKind::kSelfCalibration, now_,
        [problem = calibration_problem(map_, camera_.color, keyframe_velocities(log_, map_), sensor_.value),
         expected = expected_time_sigmas(options_.self_calibration),
         max_sigma_share = options_.self_calibration.max_sigma_share, options = options_.full] {
          return adjust_with_sensor(problem, expected, max_sigma_share, options);
        });
    keyframes_to_calibrate_ *= 2;
  }
  times_.add("mapping", watch);
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
  apply_finished_work(executor_->drain());
  if (loop_pending_) {
    map_.apply(correct_loop(loop_problem(map_, std::move(pending_merges_), options_.loop), options_.loop));
    map_.raise_epoch();
    pending_merges_.clear();
    loop_pending_ = false;
  }
  if (options_.full_adjustment) {
    const Stopwatch watch;
    sensor_ = adjust_finally(map_, log_, camera_.color, sensor_, options_.full, options_.tracking.pose,
                             options_.self_calibration, progress);
    map_.raise_epoch();
    times_.add("final adjustment", watch);
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
