// kinloop run: a sequence in, a trajectory, a map and a report out.

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "apps/commands.hpp"
#include "apps/frame_recorder.hpp"
#include "apps/interrupt.hpp"
#include "apps/loop_pictures.hpp"
#include "apps/map_store.hpp"
#include "apps/memory.hpp"
#include "apps/open_source.hpp"
#include "apps/progress_bar.hpp"
#include "apps/report_file.hpp"
#include "apps/run_arguments.hpp"
#include "apps/run_narrator.hpp"
#include "apps/run_summary.hpp"
#include "apps/run_warnings.hpp"
#include "apps/show_run.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/base/output_check.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/eval/run_up.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/optimize/g2o_file.hpp"
#include "kinloop/output/run_folder.hpp"
#include "kinloop/sensor/camera_file.hpp"
#include "kinloop/sensor/paced_source.hpp"
#include "kinloop/slam/dense_recorder.hpp"
#include "kinloop/slam/frame_pipeline.hpp"

namespace kinloop {
namespace {

/// A map file to go on with.
struct StartMap {
  MapReader reader;
  SavedMap saved;
};

std::optional<StartMap> open_start_map(const RunArguments& arguments) {
  if (arguments.localize && arguments.load_map.empty())
    throw UsageError("--localize requires --load-map FILE");
  if (arguments.localize && !arguments.save_map.empty())
    throw UsageError("--localize leaves the map as it is: there is nothing to save with --save-map");
  if (arguments.load_map.empty()) return std::nullopt;
  MapReader reader(arguments.load_map);
  SavedMap saved = read_map_or_warn(reader, arguments.load_map);
  return StartMap{std::move(reader), std::move(saved)};
}

RunOptions options_of(const RunArguments& arguments, const std::optional<StartMap>& start, int threads) {
  RunOptions options;
  // What a map was made of is looked for in the frames, too.
  if (start) options = with_options_of(start->saved, options, "features.");
  const std::string features = options.slam.features.kind;
  options.slam.full.threads = threads;
  options.slam.localize_only = arguments.localize;
  if (arguments.pace_hz > 0 || is_live(arguments.sequence)) options.slam.executor.mode = "live";
  options = with_assignments(options, arguments.assignments);
  if (start && options.slam.features.kind != features)
    throw UsageError(fmt::format("features.kind: the map was made with {}", features));
  if (arguments.no_loop) options.slam.loop.enabled = false;
  if (arguments.solver != "auto") options.slam.loop.pose_graph.solver = arguments.solver;
  if (!pose_graph_solver_available(options.slam.loop.pose_graph.solver)) {
    throw UsageError(fmt::format("solver {}: not in this build; take builtin or ceres, or leave --solver out",
                                 options.slam.loop.pose_graph.solver));
  }
  return options;
}

SourceRequest request_of(const RunArguments& arguments, const RunOptions& options, int threads) {
  SourceRequest request;
  request.sequence = arguments.sequence;
  if (!arguments.camera.empty()) request.camera = arguments.camera;
  if (!arguments.topics.empty()) request.topics = arguments.topics;
  request.simulation = options.sim;
  request.kinect = options.kinect;
  request.threads = threads;
  return request;
}

/// Gives the frames of `source` at a camera's pace; the result belongs to `source`.
const PacedSource* pace(std::unique_ptr<FrameSource>& source, double hz) {
  auto paced = std::make_unique<PacedSource>(std::move(source), hz);
  const PacedSource* result = paced.get();
  source = std::move(paced);
  return result;
}

/// Feeds all frames, each when `leave` was given; false when Ctrl-C ended it early.
bool process_all(FrameSource& source, Slam& slam, MapSaver* saver, const Progress& progress,
                 const std::function<void()>& leave) {
  FramePipeline pipeline(source, slam);
  size_t done = 0;
  while (const auto frame = pipeline.next()) {
    if (leave) leave();
    const FrameResult result = slam.process(*frame);
    ++done;
    if (progress) progress({"mapping", done, source.info().frames, run_note(result, slam.map())});
    if (saver != nullptr) saver->save_if_due();
    if (!interrupted()) continue;
    // A second Ctrl-C ends the program before the map is finished.
    if (saver != nullptr) saver->try_to_save();
    log::warn("interrupted: finishing with the {} frames there are", slam.session_log().size());
    return false;
  }
  return true;
}

/// Puts the map that the run goes on with in its place; its images only where there is a `recorder` for them.
void take_start_map(StartMap& start, const std::filesystem::path& path, Slam& slam, DenseRecorder* recorder) {
  const uint32_t shift = slam.add_map(std::move(start.saved));
  if (recorder != nullptr) restore_images(start.reader, path, shift, *recorder);
}

/// Whether tracking was lost at the end, or never began: what the exit code tells scripts.
ExitCode tracking_exit_code(const Slam& slam, const std::filesystem::path& details) {
  const auto log = slam.session_log();
  if (!log.empty() && tracked_in(slam.component(), log.back(), slam.map())) return ExitCode::kDone;
  log::error("{}; see {}", loss_text(slam.map()), details.string());
  return ExitCode::kTrackingLost;
}

void warn_of_skipped(const FrameSource& source) {
  const auto skipped = source.skipped();
  if (skipped.empty()) return;
  log::warn("{} frames were skipped; the first: {}: {}", skipped.size(), skipped.front().name,
            skipped.front().reason);
}

/// The camera as the run takes it: with a map to go on with, depth is kept in the units of its images.
RgbdCamera camera_of(const FrameSource& source, const std::optional<StartMap>& start,
                     const RunArguments& arguments) {
  RgbdCamera camera = source.camera();
  if (!start) return camera;
  require_same_camera(start->saved, arguments.load_map, camera);
  camera.depth_scale = start->saved.camera.depth_scale;
  return camera;
}

/// Who saves the map; nobody where it must stay as it is.
std::unique_ptr<MapSaver> saver_of(const RunArguments& arguments, const RunFolder& folder,
                                   const MapSaver::What& what) {
  if (arguments.localize) return nullptr;
  const auto path = arguments.save_map.empty() ? folder.map_file() : arguments.save_map;
  require_writable_file(path);
  return std::make_unique<MapSaver>(path, what, arguments.autosave_s);
}

nlohmann::json map_file_json(const MapSaver& saver) {
  return {{"path", saver.path().string()},
          {"bytes", std::filesystem::file_size(saver.path())},
          {"save_s", saver.seconds()}};
}

/// The cloud, and how it is written.
struct UprightMap {
  ColoredCloud cloud;
  UpEstimate up;
  FileFrame frame;
};

UprightMap upright_map(const Slam& slam, DenseRecorder& recorder, const std::string& frame, int threads,
                       const Progress& progress) {
  UprightMap map{recorder.fuse(slam, threads, progress), recorder.up(slam), {}};
  map.frame = file_frame(frame, map.up, recorder.views(slam));
  return map;
}

/// What run.json holds; `map` is missing where only poses were asked for.
nlohmann::json summary_of(const RunOutcome& outcome, const DenseRecorder& recorder,
                          const std::optional<UprightMap>& map) {
  auto summary = run_summary(outcome);
  summary["rooms"].update(rooms_json(recorder.times()));
  if (!map) return summary;
  summary["up"] = to_json(map->up);
  summary["map"].update(to_json(map->frame));
  return summary;
}

/// What --localize leaves without --report.
void write_poses(const RunFolder& folder, const Trajectory& trajectory, const FrameTable& frames,
                 const nlohmann::json& summary) {
  write_tum_trajectory(folder.trajectory(), trajectory);
  write_frame_table(folder.frames(), frames);
  write_file(folder.figures(), summary.dump(2) + "\n");
}

void write_results(const RunFolder& folder, const RunOutcome& outcome, const Trajectory& trajectory,
                   const std::optional<UprightMap>& map, const DenseRecorder& images,
                   const FrameTable& frames, const nlohmann::json& summary) {
  if (!map) return write_poses(folder, trajectory, frames, summary);
  const Slam& slam = outcome.slam;
  write_run_files(folder, {trajectory, keyframe_trajectory(slam.map(), slam.component()),
                           outcome.source.info().ground_truth, map->cloud, map->frame, summary});
  write_camera_file(folder.camera(), calibrated_camera(outcome.source.camera(), slam.sensor()));
  write_g2o(folder.graph(), {make_pose_graph(slam.map(), outcome.options.slam.loop), {}, true, {}});
  write_frame_table(folder.frames(), frames);
  write_loop_pictures(folder, slam, outcome.source.camera(), images);
  write_report(folder);
}

void print_summary(const nlohmann::json& summary, const RunFolder& folder, bool poses_only) {
  fmt::print(
      "{}results    {} ({})\n", summary_text(summary), folder.path().string(),
      poses_only ? "trajectory.txt; --report adds cloud and report" : "trajectory.txt, map.ply, report.html");
}

ExitCode run(const RunArguments& arguments) {
  const Stopwatch watch;
  const int threads = arguments.threads > 0 ? arguments.threads : hardware_threads();
  auto start = open_start_map(arguments);
  const RunOptions options = options_of(arguments, start, threads);
  auto source = open_source(request_of(arguments, options, threads));
  const RunFolder folder(arguments.output);
  const PacedSource* paced = arguments.pace_hz > 0 ? pace(source, arguments.pace_hz) : nullptr;
  const Progress progress = arguments.verbose ? narrate_stages() : make_progress_bar(arguments.quiet);
  const RgbdCamera camera = camera_of(*source, start, arguments);
  Slam slam(camera, options.slam, open_vocabulary(arguments.vocabulary, options.slam.features));
  DenseRecorder recorder(camera, options.dense, options.slam.executor);
  FrameRecorder frames;
  DepthWatch depth(options.dense, source->camera().depth_scale);
  const bool poses_only = arguments.localize && !arguments.report;
  if (!poses_only) slam.listen(recorder);
  slam.listen(frames);
  slam.listen(depth);
  RunNarrator narrator;
  if (arguments.verbose) {
    narrate_start(*source, threads);
    slam.listen(narrator);
  }
  if (start) take_start_map(*start, arguments.load_map, slam, poses_only ? nullptr : &recorder);
  const auto saver = saver_of(arguments, folder, {slam, recorder, options, arguments.sequence});
  catch_interrupts();
  const auto save_now = [&] {
    if (poses_only) return write_tum_trajectory(folder.trajectory(), slam.trajectory());
    save_map(folder, slam, recorder, arguments.frame, threads);
    if (saver) saver->try_to_save();
  };
  const auto shown = show_run(arguments.viewer, *source, options.viewer, slam, save_now);
  const bool complete = process_all(*source, slam, saver.get(), progress, shown ? shown->leave : nullptr);
  if (shown) shown->viewer.tell("final adjustment");
  const Trajectory trajectory = slam.finish(progress);
  if (shown) shown->viewer.finish(slam.session_log(), slam.map());
  const bool saved = saver != nullptr && saver->try_to_save();
  return_freed_memory();
  std::optional<UprightMap> map;
  if (!poses_only) map = upright_map(slam, recorder, arguments.frame, threads, progress);
  return_freed_memory();
  warn_of_skipped(*source);

  const auto evaluation = evaluate(trajectory, source->info().ground_truth);
  const size_t dropped = paced != nullptr ? paced->dropped() : 0;
  const auto points = map ? std::optional(map->cloud.size()) : std::nullopt;
  const RunOutcome outcome{*source,        slam,    options,   evaluation, points,
                           watch.wall_s(), threads, !complete, dropped};
  auto summary = summary_of(outcome, recorder, map);
  if (saved) summary["map_file"] = map_file_json(*saver);
  write_results(folder, outcome, trajectory, map, recorder, frames.table(slam.times()), summary);
  if (!arguments.quiet) print_summary(summary, folder, poses_only);
  const bool useful = judge_result(outcome, trajectory, depth);
  if (shown) stay_open(shown->viewer);
  if (!useful || (saver && !saved)) return ExitCode::kBadInput;
  return tracking_exit_code(slam, map ? folder.report() : folder.frames());
}

void print_options() {
  RunOptions options;
  fmt::print("Options for --set key=value, with their defaults:\n{}", options_help(option_entries(options)));
}

}  // namespace

void add_run_command(CLI::App& app, ExitCode& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Map a sequence: trajectory, coloured map, report");
  add_run_arguments(*command, *arguments);
  command->callback([arguments, &exit_code] {
    if (arguments->list_options) return print_options();
    if (arguments->sequence.empty())
      throw UsageError(
          "kinloop run: SEQUENCE is missing, e.g. kinloop run sim:room -o out; see kinloop run --help");
    arguments->load_map = map_file_of(arguments->load_map);
    exit_code = run(*arguments);
  });
}

}  // namespace kinloop
