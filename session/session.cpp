#include "session/session.hpp"

#include <opencv2/core/utility.hpp>

#include "dense/files/ply.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"

namespace kinloop {
namespace {

/// Must run before any OpenCV function. OpenCV promises the same results on any number of threads for few of
/// its functions; those that the library calls give the same bytes with OpenCV 4.6
/// (tests/tracking/front_end_test.cpp).
const SlamOptions& without_opencv_threads(const SlamOptions& options) {
  cv::setNumThreads(1);
  return options;
}

}  // namespace

SlamOptions default_slam_options() {
  SlamOptions options;
  options.global_ba.threads = hardware_threads();
  return options;
}

Session::Session(FrameSource& source, const SessionOptions& options)
    : Session(source, options, source.camera(), load_default_vocabulary()) {}

Session::Session(FrameSource& source, const SessionOptions& options, const RgbdCamera& camera,
                 Vocabulary vocabulary)
    : source_(source),
      threads_(options.threads > 0 ? options.threads : hardware_threads()),
      slam_(camera, without_opencv_threads(options.slam), std::move(vocabulary)),
      recorder_(camera, options.dense, options.slam.executor),
      input_(camera) {
  slam_.add_listener(advisor_);
  if (options.record_images) slam_.add_listener(recorder_);
}

const Trajectory& Session::run(const Progress& progress) {
  size_t done = 0;
  while (const auto frame = next()) {
    process(*frame);
    if (!report(progress, "mapping", ++done, source_.info().frames)) break;
  }
  return finish(progress);
}

std::optional<Frame> Session::next() {
  if (!pipeline_) pipeline_.emplace(source_, slam_.front_end());
  pipeline_->extract_features_ahead(slam_.expects_keypoints());
  return pipeline_->next();
}

TrackedFrame Session::track(const Frame& frame) {
  input_.observe(frame);
  return slam_.track(frame);
}

const Trajectory& Session::finish(const Progress& progress) {
  pipeline_.reset();
  trajectory_ = slam_.finish(progress);
  const SourceInfo& info = source_.info();
  input_.finish(slam_, info.truth_in_metres ? info.ground_truth : Trajectory{});
  return trajectory_;
}

MapCloud Session::cloud(const Progress& progress) {
  MapCloud map{recorder_.fuse(slam_, threads_, progress), recorder_.up(slam_), {}};
  const auto views = recorder_.views(slam_);
  map.frame = z_up_frame(map.up.direction, views.empty() ? SE3() : views.front().T_world_camera);
  return map;
}

void Session::write_trajectory(const std::filesystem::path& path) const {
  const auto note = note_on_doubtful_poses(slam_.session_log(), slam_.map(), DoubtfulPoses::kLeftOut);
  write_tum_trajectory(path, trajectory(), note);
}

void Session::write_cloud(const std::filesystem::path& path) {
  const MapCloud map = cloud();
  write_ply(path, map.cloud, map.frame);
}

void Session::write_map(const std::filesystem::path& path, const MapFileNotes& notes) {
  recorder_.wait_for_jobs();
  SavedMap saved = slam_.saved_map(notes.input.empty() ? source_.info().name : notes.input);
  saved.program = notes.program;
  saved.options = notes.options;
  kinloop::write_map(path, saved, recorder_.image_count(),
                     [this](size_t index) { return recorder_.saved_images(index); });
}

}  // namespace kinloop
