#include "session/store/dense_recorder.hpp"

#include <algorithm>
#include <unordered_map>

#include "dense/cloud/color_gains.hpp"
#include "dense/surfels/fuse_surfels.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/tracking/front_end.hpp"

namespace kinloop {
namespace {

constexpr size_t kMebibyte = size_t{1} << 20;
constexpr const char* kJobKind = "dense keyframes";

SurfelCamera surfel_camera(const RgbdCamera& camera) {
  return {camera.color.fx, camera.sensor.noise};
}

DenseOptions within_range(DenseOptions options, const DepthSensor& sensor) {
  options.limits = within_range(options.limits, sensor);
  return options;
}

}  // namespace

DenseRecorder::DenseRecorder(const RgbdCamera& camera, const DenseOptions& options,
                             const ExecutorOptions& executor)
    : camera_(camera),
      options_(within_range(options, camera.sensor)),
      images_({.depth_scale = camera.depth_scale, .jpeg_quality = options.jpeg_quality},
              static_cast<size_t>(options.image_memory_mib) * kMebibyte),
      surfel_store_(static_cast<size_t>(options.surfel_memory_mib) * kMebibyte),
      lag_frames_(executor.dense_lag_frames),
      executor_(make_executor(executor)) {
  validate(options, "dense.");
}

void DenseRecorder::on_frame(const TrackedFrame& tracked) {
  complete(executor_->collect(tracked.id));
  if (!tracked.is_lost()) {
    ++frames_, ++frames_since_recorded_;
    if (should_record(tracked)) {
      pending_.push_back({tracked.id, tracked.frame->color, depth_at_rest_m(*tracked.frame, tracked.moved)});
      frames_since_recorded_ = 0;
    }
  }
  constexpr size_t kMaxPending = 8;  // limits memory: a slow machine waits
  if (pending_.size() >= kMaxPending) complete(executor_->drain());
  submit(tracked.id);
}

/// Records every keyframe, and other frames while fewer than kMinImages evenly spread images cover the run so
/// far. n frames give at most about kMinImages * (1 + ln(n / 40)) extra images, and none if keyframes come
/// more often than every n / kMinImages frames, as in any long handheld recording.
bool DenseRecorder::should_record(const TrackedFrame& tracked) const {
  constexpr uint32_t kMinImages = 8, kMinGapFrames = 5;
  if (tracked.keyframe.valid()) return true;
  if (options_.frame_step > 0 && tracked.id.value % static_cast<uint32_t>(options_.frame_step) == 0)
    return true;
  return tracked.is_tracked_by_landmarks() &&
         frames_since_recorded_ >= std::max(kMinGapFrames, frames_ / kMinImages);
}

void DenseRecorder::submit(FrameId now) {
  if (pending_.empty() || executor_->busy(kJobKind)) return;
  auto encode = [this, pending = std::exchange(pending_, {}), encoding = images_.encoding(),
                 lens = surfel_camera(camera_), options = options_]() -> Completion {
    std::vector<EncodedFrame> done;
    for (const PendingFrame& keyframe : pending) {
      StoredImages images = encode_images(keyframe.color, keyframe.depth_m, encoding);
      done.push_back({keyframe.frame, std::move(images.encoded)});
      // From what a map file stores, so that a saved map gives the same cloud as its run.
      if (!options.surfels_at_end)
        done.back().surfels = to_bytes(extract_surfels(images.decoded, lens, options));
    }
    return [this, done = std::move(done)]() mutable { add(std::move(done)); };
  };
  executor_->submit(now, {kJobKind, lag_frames_, std::move(encode)});
}

void DenseRecorder::add(std::vector<EncodedFrame> frames) {
  for (EncodedFrame& frame : frames) {
    images_.add(frame.images);
    recorded_.push_back({frame.frame, {}});
    if (frame.surfels) recorded_.back().surfels = surfel_store_.add(*std::move(frame.surfels));
  }
}

void DenseRecorder::complete(const std::vector<FinishedJob>& jobs) {
  for (const FinishedJob& job : jobs) {
    timings_.add(std::string(job.kind), job.elapsed);
    job.complete();
  }
}

void DenseRecorder::wait_for_jobs() {
  complete(executor_->drain());
  submit({});
  complete(executor_->drain());
}

void DenseRecorder::restore(const SavedImages& saved) {
  // Images of another size do not match the camera.
  if (saved.images.rows != camera_.color.height || saved.images.cols != camera_.color.width) return;
  images_.add(saved.images);
  recorded_.push_back({saved.frame, {}});
}

std::vector<PosedImage> DenseRecorder::views(const FrameLog& log, const Map& map, uint32_t component) const {
  const auto velocities = frame_velocities(log, map);
  std::unordered_map<FrameId, size_t> entry_of;
  for (size_t i = 0; i < log.size(); ++i) {
    if (is_tracked_in(component, log[i], map)) entry_of.emplace(log[i].id, i);
  }
  std::vector<PosedImage> views;
  for (size_t i = 0; i < recorded_.size(); ++i) {
    const auto entry = entry_of.find(recorded_[i].frame);
    if (entry == entry_of.end()) continue;
    const LoggedFrame& logged = log[entry->second];
    views.push_back({i, logged.world(map), velocities[entry->second],
                     static_cast<double>(logged.depth_stamp_difference_s)});
  }
  return views;
}

void DenseRecorder::extract_missing_surfels(int threads) {
  std::vector<size_t> missing;
  for (size_t i = 0; i < recorded_.size(); ++i) {
    if (!recorded_[i].surfels) missing.push_back(i);
  }
  const auto batch_size = static_cast<size_t>(std::max(threads, 1));
  for (size_t first = 0; first < missing.size(); first += batch_size) {
    std::vector<std::vector<uint8_t>> made(std::min(batch_size, missing.size() - first));
    parallel_for(made.size(), threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        made[i] =
            to_bytes(extract_surfels(images_.load(missing[first + i]), surfel_camera(camera_), options_));
      }
    });
    for (size_t i = 0; i < made.size(); ++i)
      recorded_[missing[first + i]].surfels = surfel_store_.add(std::move(made[i]));
  }
}

std::vector<PosedImage> DenseRecorder::with_color_gains(std::span<const PosedImage> views,
                                                        const DenseCamera& camera, int threads) {
  std::vector<PosedImage> corrected(views.begin(), views.end());
  if (!options_.compensate_exposure) return corrected;
  wait_for_jobs();
  extract_missing_surfels(threads);
  const Stopwatch watch;
  const auto gains = color_gains([this](size_t image) { return surfels(image); }, views, camera, threads);
  for (size_t i = 0; i < gains.size(); ++i) corrected[i].color_gain = gains[i];
  timings_.add("dense color correction", watch.elapsed());
  return corrected;
}

ColoredCloud DenseRecorder::fuse_views(std::span<const PosedImage> views, const DenseCamera& camera,
                                       int threads, const Progress& progress) {
  wait_for_jobs();
  extract_missing_surfels(threads);  // also without colour gains
  const auto corrected = with_color_gains(views, camera, threads);
  const Stopwatch watch;
  ColoredCloud cloud = fuse_surfels([this](size_t image) { return surfels(image); }, corrected, camera,
                                    options_, threads, progress);
  timings_.add("dense fusion", watch.elapsed());
  return cloud;
}

std::optional<UpEstimate> DenseRecorder::given_up() const {
  const Eigen::Vector3d up(options_.up_x, options_.up_y, options_.up_z);
  if (!(up.norm() > 0)) return std::nullopt;
  return UpEstimate{up.normalized(), UpSource::kGiven, 1};
}

UpEstimate DenseRecorder::up(std::span<const PosedImage> views, const DenseCamera& camera) {
  if (const auto given = given_up()) return *given;
  wait_for_jobs();
  const auto load_surfels = [this](size_t image) {
    return recorded_[image].surfels ? surfels(image)
                                    : extract_surfels(images_.load(image), surfel_camera(camera_), options_);
  };
  std::vector<SE3> T_world_cameras;
  for (const PosedImage& view : views) T_world_cameras.push_back(view.T_world_camera);
  const Stopwatch watch;
  UpEstimate up = estimate_up_direction(surface_normals(load_surfels, views, camera), T_world_cameras);
  timings_.add("up direction", watch.elapsed());
  return up;
}

std::optional<RgbdImages> DenseRecorder::images_of(FrameId frame) const {
  const auto recorded = std::find_if(recorded_.begin(), recorded_.end(),
                                     [&](const RecordedImage& k) { return k.frame == frame; });
  if (recorded == recorded_.end()) return std::nullopt;
  return images_.load(static_cast<size_t>(recorded - recorded_.begin()));
}

DenseCamera time_calibrated_camera(const RgbdCamera& camera, const SensorEstimate& estimate) {
  const SensorVector& corrections = estimate.sensor.corrections;
  return {.color = camera.color,
          .depth_delay_s = corrections(kDepthDelay),
          .readout_s = corrections(kDepthShutter),
          .noise = camera.sensor.noise,
          .color_readout_s = corrections(kRollingShutter)};
}

DenseCamera dense_camera(const RgbdCamera& camera, const SensorEstimate& estimate) {
  DenseCamera dense = time_calibrated_camera(camera, estimate);
  dense.color = calibrated_camera(camera, estimate).color;
  dense.inverse_depth_correction = estimate.sensor.corrections.segment<6>(kInverseDepthBias);
  return dense;
}

}  // namespace kinloop
