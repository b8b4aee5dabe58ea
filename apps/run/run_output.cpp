#include "apps/run/run_output.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "apps/run/summary/loop_pictures.hpp"
#include "apps/shared/files/report_file.hpp"
#include "apps/shared/terminal/failure.hpp"
#include "dense/files/ply.hpp"
#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "session/process.hpp"
#include "tools/export/g2o/g2o_file.hpp"
#include "tools/export/trajectory_writer.hpp"
#include "viewer/report/run_up_direction.hpp"

namespace kinloop {
namespace {

/// Returns the map saver, or null if the map must not be saved.
std::unique_ptr<MapSaver> saver_of(const RunArguments& arguments, const RunFolder& folder,
                                   const MapSaver::Contents& what) {
  if (arguments.request.settings.localize) return nullptr;
  const auto path = arguments.save_map.empty() ? folder.map_file() : arguments.save_map;
  if (output_place(path).is_stream)
    throw UsageError(fmt::format(
        "--save-map {}: not a regular file, which is needed to save the map repeatedly", path.string()));
  return std::make_unique<MapSaver>(path, what, arguments.autosave_s);
}

nlohmann::json map_file_json(const MapSaver& saver) {
  return {{"path", saver.path().string()},
          {"bytes", std::filesystem::file_size(saver.path())},
          {"save_s", saver.latest().wall_s}};
}

}  // namespace

RunOutput::RunOutput(const RunArguments& arguments, const RunPlan& plan, Session& session)
    : folder_(arguments.output),
      frame_(arguments.frame),
      poses_only_(arguments.poses_only()),
      trajectory_copy_(arguments.trajectory),
      doubtful_(arguments.keep_doubtful ? DoubtfulPoses::kKept : DoubtfulPoses::kLeftOut),
      plan_(plan),
      session_(session),
      frames_(!plan.source->info().ground_truth.empty()),
      depth_(plan.options.dense, plan.source->camera().depth_scale),
      saver_(saver_of(arguments, folder_,
                      {session.slam(), session.recorder(), plan.options, plan.source->info().name})),
      outcome_{plan, session.slam()} {
  if (saver_ && !arguments.save_map.empty()) map_lock_.emplace(saver_->path());  // the folder is locked
  session.add_listener(frames_);
  session.add_listener(depth_);
}

void RunOutput::save_if_due() {
  if (saver_) saver_->save_if_due();
}

bool RunOutput::try_save_map_file() {
  return saver_ == nullptr || saver_->try_save();
}

void RunOutput::save_now() {
  write_trajectory();
  if (poses_only_) return;
  const MapCloud map = cloud({});
  write_ply(folder_.map(), map.cloud, map.frame);
  try_save_map_file();
}

nlohmann::json RunOutput::write(const RunEnding& ending, const Progress& progress) {
  saved_ = try_save_map_file();
  release_freed_memory();
  if (!poses_only_) map_ = cloud(progress);
  release_freed_memory();
  if (map_) outcome_.map_points = map_->cloud.size();
  if (map_) warn_of_unlikely_up(map_->up);
  outcome_.warnings = session_.input().warnings();
  outcome_.advisor = session_.advisor();
  outcome_.live_poses = frames_.live_poses(session_.slam().session_log(), session_.slam().map());
  outcome_.latencies_ms = frames_.latencies_ms();
  outcome_.ages_ms = frames_.ages_ms();
  outcome_.evaluation = evaluate(trajectory(), plan_.source->info().ground_truth);
  outcome_.wall_s = ending.since_start.wall_s();
  outcome_.interrupted = !ending.complete;

  const Stopwatch writing;
  auto all = summary();
  write_results();
  Timings program = session_.recorder().timings();
  for (const auto& [module, elapsed] : session_.input().timings().modules) program.add(module, elapsed);
  program.add("startup", ending.startup);
  if (saver_) program.add("saving the map", saver_->total());
  program.add("writing", writing.elapsed());
  add_timings(all, session_.slam().timings(), program);
  write_file(folder_.run_json(), json_text(all, 2) + "\n");
  if (map_) write_report(folder_);
  write_trajectory_copy();
  return all;
}

bool RunOutput::check() const {
  if (!saved_) tell_error_code("output");
  return check_result(outcome_, trajectory(), depth_) && saved_;
}

TrajectoryCovariances RunOutput::covariances() const {
  return covariances_of(session_.slam().session_log(), session_.slam().map(), doubtful_);
}

/// Writes the trajectory with its covariances.
void RunOutput::write_trajectory() const {
  const Trajectory poses = trajectory();
  write_tum_trajectory(folder_.trajectory(), poses, trajectory_note());
  write_covariances(folder_.covariances(), poses, covariances());
}

/// Writes the file of --trajectory.
void RunOutput::write_trajectory_copy() const {
  if (trajectory_copy_.empty()) return;
  const Trajectory poses = trajectory();
  require_pose_of_each_frame(trajectory_copy_, poses.size(), session_.slam().session_log().size());
  write_trajectory_file(trajectory_copy_, poses, trajectory_note());
}

std::string RunOutput::trajectory_note() const {
  auto note = note_on_doubtful_poses(session_.slam().session_log(), session_.slam().map(), doubtful_);
  if (note.empty() || doubtful_ == DoubtfulPoses::kKept) return note;
  return note + "; --keep-doubtful keeps them";
}

/// Returns the cloud in the frame given by `--frame`.
MapCloud RunOutput::cloud(const Progress& progress) {
  MapCloud map = session_.cloud(progress);
  if (frame_ == "camera") map.frame = {};
  return map;
}

nlohmann::json RunOutput::summary() const {
  auto summary = run_summary(outcome_);
  if (saver_ && saved_) summary["map_file"] = map_file_json(*saver_);
  if (!map_) return summary;
  summary["up"] = to_json(map_->up);
  summary["map"].update(to_json(map_->frame));
  return summary;
}

/// Writes what moves with the camera as a mask for --mask; an old file is removed if there is nothing.
void RunOutput::write_mask() const {
  const cv::Mat mask = session_.slam().camera_mask();
  if (mask.empty()) {
    std::filesystem::remove(folder_.mask());
  } else {
    write_png(folder_.mask(), mask);
  }
}

/// Writes everything but run.json and the report.
void RunOutput::write_results() const {
  const Slam& slam = session_.slam();
  const FrameSource& source = *plan_.source;
  write_frame_table(folder_.frames(), frames_.table(slam.session_log(), slam.timings()));
  write_tum_trajectory(folder_.live(), trajectory_of(outcome_.live_poses));
  write_mask();
  if (!map_) return write_trajectory();
  write_run_files(
      folder_, {trajectory(), keyframe_trajectory(slam.map(), slam.component()), source.info().ground_truth,
                map_->cloud, map_->frame, nullptr, covariances(), trajectory_note()});
  write_camera_file(folder_.camera(), calibrated_camera(source.camera(), slam.sensor_estimate()));
  write_g2o(folder_.graph(), {make_pose_graph(slam.map(), plan_.options.slam.loop), {}, true, {}});
  write_loop_pictures(folder_, slam, session_.recorder());
}

}  // namespace kinloop
