#include "kinloop/slam/dense_recorder.hpp"

#include <algorithm>
#include <unordered_map>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/dense/color_gains.hpp"
#include "kinloop/dense/surface_normals.hpp"

namespace kinloop {
namespace {

constexpr size_t kMebibyte = size_t{1} << 20;

ImageStoreOptions store_options(const RgbdCamera& camera, const DenseOptions& options) {
  ImageStoreOptions store;
  store.depth_scale = camera.depth_scale;
  store.jpeg_quality = options.jpeg_quality;
  store.memory_limit_bytes = static_cast<size_t>(options.image_memory_mib) * kMebibyte;
  return store;
}

/// Of the images as they are kept, so that the cloud of a saved map is that of its run.
std::vector<uint8_t> packed_patch(const EncodedImages& images, const ImageStoreOptions& store,
                                  double focal_px, const DenseOptions& options) {
  return to_bytes(make_patch(decode_images(images, store), focal_px, options));
}

}  // namespace

DenseRecorder::DenseRecorder(const RgbdCamera& camera, const DenseOptions& options,
                             const ExecutorOptions& executor)
    : camera_(camera),
      options_(options),
      images_(store_options(camera, options)),
      patches_(static_cast<size_t>(options.patch_memory_mib) * kMebibyte),
      executor_(make_executor(executor)) {}

void DenseRecorder::on_frame(const FrameResult& result, const PreparedFrame& frame) {
  take_in(executor_->collect(frame.id));
  if (result.status != TrackStatus::kLost) {
    ++frames_, ++frames_since_kept_;
    if (wants(result)) {
      waiting_.push_back({result.frame, {frame.color, frame.depth_m}});
      frames_since_kept_ = 0;
    }
  }
  constexpr size_t kMostWaiting = 8;  // a slow machine waits rather than fill its memory with images
  if (waiting_.size() >= kMostWaiting) take_in(executor_->drain());
  submit(frame.id);
}

/// Keyframes; and other frames while fewer than kFewImages, evenly spread, stand for the frames so far.
/// However few keyframes there are, n frames give at most about kFewImages * (1 + ln(n / 40)) others, and
/// where a keyframe comes oftener than every n / kFewImages frames, as in any long recording by hand, none.
bool DenseRecorder::wants(const FrameResult& result) const {
  constexpr uint32_t kFewImages = 8, kLeastGapFrames = 5;
  if (result.keyframe.valid()) return true;
  if (options_.frame_step > 0 && result.frame.value % static_cast<uint32_t>(options_.frame_step) == 0)
    return true;
  return result.status == TrackStatus::kTracked &&
         frames_since_kept_ >= std::max(kLeastGapFrames, frames_ / kFewImages);
}

void DenseRecorder::submit(FrameId now) {
  if (waiting_.empty() || executor_->busy(JobKind::kDenseKeyframes)) return;
  executor_->submit(JobKind::kDenseKeyframes, now,
                    [waiting = std::exchange(waiting_, {}), store = images_.options(),
                     focal_px = camera_.color.fx, options = options_] {
                      std::vector<DenseKeyframe> done;
                      for (const Waiting& keyframe : waiting) {
                        EncodedImages images = encode_images(keyframe.images, store);
                        auto patch = packed_patch(images, store, focal_px, options);
                        done.push_back({keyframe.frame, std::move(images), std::move(patch)});
                      }
                      return done;
                    });
}

void DenseRecorder::take_in(std::vector<FinishedJob> jobs) {
  for (FinishedJob& job : jobs) {
    times_.add(name_of(job.kind), job.spent);
    for (DenseKeyframe& keyframe : job.result.dense) {
      images_.add(keyframe.images);
      kept_.push_back({keyframe.frame, patches_.add(std::move(keyframe.patch))});
    }
  }
}

void DenseRecorder::finish_work() {
  take_in(executor_->drain());
  submit({});
  take_in(executor_->drain());
}

void DenseRecorder::restore(const SavedImages& saved) {
  // Images of another size would not go with the camera.
  if (saved.images.rows != camera_.color.height || saved.images.cols != camera_.color.width) return;
  images_.add(saved.images);
  kept_.push_back({saved.frame, {}});
}

std::vector<PosedImage> DenseRecorder::views(const FrameLog& log, const Map& map, uint32_t component) const {
  const auto velocities = frame_velocities(log, map);
  std::unordered_map<FrameId, size_t> entry_of;
  for (size_t i = 0; i < log.size(); ++i) {
    if (tracked_in(component, log[i], map)) entry_of.emplace(log[i].frame, i);
  }
  std::vector<PosedImage> views;
  for (size_t i = 0; i < kept_.size(); ++i) {
    const auto entry = entry_of.find(kept_[i].frame);
    if (entry == entry_of.end()) continue;
    views.push_back({i, world_pose(log[entry->second], map), velocities[entry->second]});
  }
  return views;
}

void DenseRecorder::make_missing_patches(int threads) {
  std::vector<size_t> missing;
  for (size_t i = 0; i < kept_.size(); ++i) {
    if (!kept_[i].patch) missing.push_back(i);
  }
  const auto batch_size = static_cast<size_t>(std::max(threads, 1));
  for (size_t first = 0; first < missing.size(); first += batch_size) {
    std::vector<std::vector<uint8_t>> made(std::min(batch_size, missing.size() - first));
    parallel_for(made.size(), threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        made[i] =
            packed_patch(images_.encoded(missing[first + i]), images_.options(), camera_.color.fx, options_);
      }
    });
    for (size_t i = 0; i < made.size(); ++i)
      kept_[missing[first + i]].patch = patches_.add(std::move(made[i]));
  }
}

std::vector<PosedImage> DenseRecorder::with_color_gains(std::span<const PosedImage> views,
                                                        const DenseCamera& camera, int threads) {
  std::vector<PosedImage> leveled(views.begin(), views.end());
  if (!options_.even_exposure) return leveled;
  finish_work();
  make_missing_patches(threads);
  const Stopwatch watch;
  const auto gains = color_gains([this](size_t image) { return patch(image); }, views, camera, threads);
  for (size_t i = 0; i < gains.size(); ++i) leveled[i].color_gain = gains[i];
  times_.add("dense colours", watch.spent());
  return leveled;
}

ColoredCloud DenseRecorder::fuse_views(std::span<const PosedImage> views, const DenseCamera& camera,
                                       int threads, const Progress& progress) {
  finish_work();
  make_missing_patches(threads);
  const auto leveled = with_color_gains(views, camera, threads);
  const Stopwatch watch;
  ColoredCloud cloud = fuse_patches([this](size_t image) { return patch(image); }, leveled, camera, options_,
                                    threads, progress);
  times_.add("dense fusion", watch.spent());
  return cloud;
}

UpEstimate DenseRecorder::up(std::span<const PosedImage> views, const DenseCamera& camera) {
  finish_work();
  const auto patch_of = [this](size_t image) {
    const auto& patch = kept_[image].patch;
    return patch_of_bytes(
        patch ? patches_.load(*patch)
              : packed_patch(images_.encoded(image), images_.options(), camera_.color.fx, options_));
  };
  std::vector<SE3> T_world_cameras;
  for (const PosedImage& view : views) T_world_cameras.push_back(view.T_world_camera);
  return estimate_up(surface_normals(patch_of, views, camera), T_world_cameras);
}

std::optional<RgbdImages> DenseRecorder::images_of(FrameId frame) const {
  const auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.frame == frame; });
  if (kept == kept_.end()) return std::nullopt;
  return images_.load(static_cast<size_t>(kept - kept_.begin()));
}

DenseCamera timed_camera(const RgbdCamera& camera, const SensorEstimate& sensor) {
  return {camera.color, sensor.value(kDepthTime), sensor.value(kDepthShutter), Vector6d::Zero()};
}

DenseCamera dense_camera(const RgbdCamera& camera, const SensorEstimate& sensor) {
  DenseCamera dense = timed_camera(camera, sensor);
  dense.color = calibrated_camera(camera, sensor).color;
  dense.depth_offset_per_m = sensor.value.segment<6>(kDepthOffset);
  return dense;
}

}  // namespace kinloop
