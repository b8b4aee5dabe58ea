#include "python/bindings/slam.hpp"

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "dense/texture/texture_mesh.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "session/process.hpp"
#include "session/store/map_store.hpp"

namespace kinloop::python {
namespace {

uint64_t next_run_id() {
  static std::atomic<uint64_t> last = 0;
  return ++last;
}

/// Once for the process, before the first image: see `retain_freed_memory` and `Session`.
void set_up_process() {
  static const bool once = [] {
    cv::setNumThreads(1);
    retain_freed_memory();
    return true;
  }();
  static_cast<void>(once);
}

void require_size(const Frame& frame, const PinholeCamera& camera) {
  const cv::Size size(camera.width, camera.height), color = frame.color.size();
  if (color == size && frame.depth_m.size() == size) return;
  throw UsageError(
      fmt::format("frame: {} x {} pixels where the camera of this Slam has {} x {}; pass Slam the camera of "
                  "its source",
                  color.width, color.height, size.width, size.height));
}

}  // namespace

Run::Run(const RgbdCamera& camera, const RunSettings& settings)
    : camera_(camera), id_(next_run_id()), prepare_depth_(camera) {
  set_up_process();
  if (settings.localize && settings.load_map.empty())
    throw UsageError("localize=True requires load_map=FILE");
  RunSetup setup = set_up_run(settings);
  threads_ = setup.threads;
  options_ = suited_to({"", false, camera.sensor, {}}, setup.options, settings.assignments);
  auto& start = setup.start;
  if (start) camera_ = start->adapt(camera_);
  slam_.emplace(camera_, options_.slam, open_vocabulary(settings.vocabulary, options_.slam.features));
  recorder_.emplace(camera_, options_.dense, options_.slam.executor);
  input_monitor_.emplace(camera_);
  slam_->add_listener(*recorder_);
  if (!start) return;
  const uint32_t shift = slam_->add_map(std::move(start->saved));
  start->restore_images(shift, *recorder_);
}

void Run::require_unfinished() const {
  if (trajectory_) throw UsageError("Slam: finish() has ended this run; create another Slam");
}

Frame Run::prepared(const PyFrame& frame) {
  require_unfinished();
  require_size(frame.data, camera_.color);
  if (frame.prepared_for == 0 || frame.prepared_for == id_) {
    if (const auto reader = frame.reader.lock()) {
      if (input_.empty()) input_ = reader->info().name;
      reader->prepare_for(id_, slam_->front_end(), slam_->expects_keypoints());
    }
  }
  return frame.prepared_for == id_ ? frame.data : slam_->front_end().prepare(frame.raw());
}

Frame Run::prepared(const ArrayFrame& given) {
  require_unfinished();
  Frame frame;
  frame.id = FrameId{next_id_};
  frame.stamp_ns = given.stamp_ns;
  frame.depth_stamp_ns = given.depth_stamp_ns;
  frame.color = given.color;
  frame.depth_m = prepare_depth_(given.depth_m);
  frame.mask = given.mask;
  return slam_->front_end().prepare(frame);
}

TrackedFrame Run::track_next(Frame frame) {
  if (frame.stamp_ns <= last_stamp_ns_) {
    throw UsageError(fmt::format("frame at {} s after one at {} s: stamps must increase",
                                 format_stamp(frame.stamp_ns), format_stamp(last_stamp_ns_)));
  }
  last_stamp_ns_ = frame.stamp_ns;
  const uint32_t first = slam_->front_end().first_frame();
  frame.id.value = std::max(frame.id.value, first + next_id_);  // a second source begins with 0 again
  next_id_ = frame.id.value - first + 1;
  input_monitor_->observe(frame);
  return slam_->track(frame);
}

TrackedFrame Run::update_map() {
  const std::lock_guard lock(mutex_);
  if (!slam_->has_unmapped_frame()) throw UsageError("Slam.update_map: call track() before it");
  return slam_->update_map();
}

Trajectory Run::finish(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  if (!trajectory_) trajectory_ = slam_->finish(progress);
  input_monitor_->finish(*slam_, {});
  return *trajectory_;
}

std::vector<InputWarning> Run::warnings() {
  const std::lock_guard lock(mutex_);
  return input_monitor_->warnings();
}

ColoredCloud Run::fuse_cloud(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  return recorder_->fuse(*slam_, threads_, progress);
}

TexturedMesh Run::reconstruct(const MeshOptions& options, const Progress& progress) {
  const std::lock_guard lock(mutex_);
  const DenseCamera camera = dense_camera(camera_, slam_->sensor_estimate());
  const auto views = recorder_->with_color_gains(recorder_->views(*slam_), camera, threads_);
  return reconstruct_textured_mesh({recorder_->images(), views, camera}, options, threads_, progress);
}

UpEstimate Run::up() {
  const std::lock_guard lock(mutex_);
  return recorder_->up(*slam_);
}

FileFrame Run::file_frame() {
  const std::lock_guard lock(mutex_);
  return kinloop::file_frame("z-up", recorder_->up(*slam_), recorder_->views(*slam_));
}

void Run::save_map(const std::filesystem::path& path) {
  const std::lock_guard lock(mutex_);
  MapSaver(path, {*slam_, *recorder_, options_, input_.empty() ? "Python" : input_}, 0).save();
}

}  // namespace kinloop::python
