// kinloop run: maps a sequence and writes trajectory, map and report.

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "apps/run/frame_recorder.hpp"
#include "apps/run/run_arguments.hpp"
#include "apps/run/run_logger.hpp"
#include "apps/run/run_summary.hpp"
#include "apps/run/run_viewer.hpp"
#include "apps/run/run_warnings.hpp"
#include "apps/run/write_run.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/failure.hpp"
#include "apps/shared/interrupt.hpp"
#include "apps/shared/progress_bar.hpp"
#include "apps/shared/standard_output.hpp"
#include "drivers/live/paced_source.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/io/run_folder.hpp"
#include "session/map_store.hpp"
#include "session/memory.hpp"
#include "session/open_frame_source.hpp"
#include "session/session.hpp"

namespace kinloop {
namespace {

/// A map file to continue.
struct InitialMap {
  MapReader reader;
  SavedMap saved;
};

std::optional<InitialMap> open_initial_map(const RunArguments& arguments) {
  if (arguments.localize && arguments.load_map.empty())
    throw UsageError("--localize requires --load-map FILE");
  if (arguments.localize && !arguments.save_map.empty())
    throw UsageError("--localize does not change the map: it cannot be combined with --save-map");
  if (arguments.load_map.empty()) return std::nullopt;
  MapReader reader(arguments.load_map);
  SavedMap saved = read_map_with_warnings(reader, arguments.load_map);
  return InitialMap{std::move(reader), std::move(saved)};
}

RunOptions options_of(const RunArguments& arguments, const std::optional<InitialMap>& start, int threads,
                      bool live) {
  RunOptions options;
  // Frames must use the same features as the map.
  if (start) options = restore_options(start->saved, arguments.load_map, "features.");
  const FeatureKind features = options.slam.features.kind;
  options.slam.global_ba.threads = threads;
  options.slam.localize_only = arguments.localize;
  if (arguments.pace_hz > 0 || live) options.slam.executor.mode = ExecutorMode::kLive;
  if (arguments.memory_mib > 0) options = with_memory_limit(options, arguments.memory_mib);
  options = run_options_with(options, arguments.assignments);
  if (start && options.slam.features.kind != features)
    throw UsageError(fmt::format("features.kind: must be {}, as in the loaded map", name_of(features)));
  if (arguments.no_loop) options.slam.loop.enabled = false;
  if (!arguments.solver.empty())
    options = run_options_with(options, std::vector{"loop.pose_graph.solver=" + arguments.solver});
  if (!pose_graph_solver_available(options.slam.loop.pose_graph.solver)) {
    throw UsageError(
        fmt::format("solver {}: not available in this build; use builtin or ceres, or omit --solver",
                    name_of(options.slam.loop.pose_graph.solver)));
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
  request.stop = interrupted;
  return request;
}

std::unique_ptr<FrameSource> open_source(const RunArguments& arguments, const RunOptions& options,
                                         int threads) {
  auto source = open_frame_source(request_of(arguments, options, threads));
  if (!arguments.quiet) log_recognition(*source);
  return source;
}

/// Makes `source` return frames at the camera's rate. The returned pointer belongs to `source`.
const PacedSource* pace(std::unique_ptr<FrameSource>& source, double hz) {
  auto paced = std::make_unique<PacedSource>(std::move(source), hz);
  const PacedSource* result = paced.get();
  source = std::move(paced);
  return result;
}

/// How the frames ended.
enum class RunEnd { kComplete, kInterrupted, kSourceFailed };

/// Processes all frames, waiting while the run is paused (`wait_until_resumed`). A source that fails after
/// its first frame ends the run like Ctrl-C does: what has been mapped is kept. Not so a fault of the
/// program.
RunEnd process_all(Session& session, MapSaver* saver, const Progress& progress,
                   const std::function<void()>& wait_until_resumed) {
  const size_t frames = session.source().info().frames;
  size_t done = 0;
  bool failed = false;
  const auto next = [&]() -> std::optional<Frame> {
    try {
      return session.next();
    } catch (const std::logic_error&) {
      throw;
    } catch (const std::exception& error) {
      if (done == 0) throw;
      log::error("{}", describe_failure(error).message);
      failed = true;
      return std::nullopt;
    }
  };
  while (const auto frame = next()) {
    if (wait_until_resumed) wait_until_resumed();
    const TrackedFrame result = session.process(*frame);
    ++done;
    if (progress) progress({"mapping", done, frames, progress_note(result, session.slam().map())});
    if (saver != nullptr) saver->save_if_due();
    if (interrupted()) break;
  }
  if (failed) return RunEnd::kSourceFailed;
  if (!interrupted()) return RunEnd::kComplete;  // interrupted while the source was silent, too
  // A second Ctrl-C ends the program before the map is finished.
  if (saver != nullptr) saver->try_save();
  log::warn("interrupted: finishing with {} frames", session.slam().session_log().size());
  return RunEnd::kInterrupted;
}

/// Adds the map to continue to the session, and its images if they are recorded.
void apply_initial_map(InitialMap& start, const std::filesystem::path& path, Session& session,
                       bool with_images) {
  const uint32_t shift = session.add_map(std::move(start.saved));
  if (with_images) load_images(start.reader, path, shift, session.recorder());
}

/// Returns the camera for the run: when a map is continued, in the depth unit of its images.
RgbdCamera camera_of(const FrameSource& source, const std::optional<InitialMap>& start,
                     const RunArguments& arguments) {
  RgbdCamera camera = source.camera();
  if (!start) return camera;
  require_same_camera(start->saved, arguments.load_map, camera);
  camera.depth_scale = start->saved.camera.depth_scale;
  return camera;
}

/// Returns the map saver, or null if the map must not be saved.
std::unique_ptr<MapSaver> saver_of(const RunArguments& arguments, const RunFolder& folder,
                                   const MapSaver::Contents& what) {
  if (arguments.localize) return nullptr;
  const auto path = arguments.save_map.empty() ? folder.map_file() : arguments.save_map;
  require_writable_file(path);
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

/// Returns the cloud in the frame given by `--frame`.
MapCloud map_cloud(Session& session, const std::string& frame, const Progress& progress) {
  MapCloud map = session.cloud(progress);
  if (frame == "camera") map.frame = {};
  return map;
}

/// Returns the time of everything but `Slam` and writing: the start of the process until `startup`, the dense
/// map and saving.
Timings program_timings(const ElapsedTime& startup, const DenseRecorder& recorder, const MapSaver* saver) {
  Timings timings = recorder.timings();
  timings.add("startup", startup);
  if (saver != nullptr) timings.add("saving the map", saver->total());
  return timings;
}

void print_summary(const nlohmann::json& summary, const RunFolder& folder, bool poses_only) {
  print_text(fmt::format("{}results    {} ({})\n", summary_text(summary), folder.path().string(),
                         poses_only ? "trajectory.txt; use --report for cloud and report"
                                    : "trajectory.txt, map.ply, report.html"));
}

SessionOptions session_options(const RunOptions& options, int threads, bool poses_only) {
  return {options.slam, options.dense, !poses_only, threads};
}

ExitCode run(const RunArguments& arguments) {
  const Stopwatch watch;
  const int threads = arguments.threads > 0 ? arguments.threads : hardware_threads();
  auto start = open_initial_map(arguments);
  auto source = open_source(arguments, options_of(arguments, start, threads, false), threads);
  const RunOptions options =
      within_range(options_of(arguments, start, threads, source->info().live), source->camera().sensor);
  const RunFolder folder(arguments.output);
  const PacedSource* paced = arguments.pace_hz > 0 ? pace(source, arguments.pace_hz) : nullptr;
  const Progress progress = arguments.verbose ? make_stage_logger() : make_progress_bar(arguments.quiet);
  const bool poses_only = arguments.localize && !arguments.report;
  Session session(*source, session_options(options, threads, poses_only),
                  camera_of(*source, start, arguments),
                  open_vocabulary(arguments.vocabulary, options.slam.features));
  const Slam& slam = session.slam();
  FrameRecorder frames;
  DepthMonitor depth(options.dense, source->camera().depth_scale);
  session.add_listener(frames);
  session.add_listener(depth);
  RunLogger run_logger;
  if (arguments.verbose) {
    log_run_start(*source, threads);
    session.add_listener(run_logger);
  }
  if (start) apply_initial_map(*start, arguments.load_map, session, !poses_only);
  const auto saver = saver_of(arguments, folder, {slam, session.recorder(), options, arguments.sequence});
  install_interrupt_handler();
  const auto save_now = [&] {
    if (poses_only) return write_tum_trajectory(folder.trajectory(), session.trajectory());
    save_map(folder, slam, session.recorder(), arguments.frame, threads);
    if (saver) saver->try_save();
  };
  const auto shown = start_run_viewer(arguments.viewer, options.viewer, session, save_now);
  const ElapsedTime startup{watch.wall_s(), process_cpu_s()};
  const RunEnd end = process_all(session, saver.get(), progress, shown ? shown->wait_until_resumed : nullptr);
  if (shown) shown->viewer.set_stage("final bundle adjustment");
  const Trajectory& trajectory = session.finish(progress);
  if (shown) shown->viewer.finish(slam.session_log(), slam.map());
  const bool saved = saver != nullptr && saver->try_save();
  release_freed_memory();
  std::optional<MapCloud> map;
  if (!poses_only) map = map_cloud(session, arguments.frame, progress);
  release_freed_memory();

  const auto evaluation = evaluate(trajectory, source->info().ground_truth);
  const size_t dropped = paced != nullptr ? paced->dropped() : 0;
  const auto points = map ? std::optional(map->cloud.size()) : std::nullopt;
  const RunOutcome outcome{
      *source, slam, options, evaluation, points, watch.wall_s(), threads, end != RunEnd::kComplete, dropped};
  const auto summary =
      write_run(folder, {outcome, trajectory, map, session.recorder(), frames.table(slam.timings()),
                         saved ? map_file_json(*saver) : nullptr,
                         program_timings(startup, session.recorder(), saver.get())});
  if (!arguments.quiet) print_summary(summary, folder, poses_only);
  if (arguments.profile) print_text(profile_text(summary));
  const bool useful = check_result(outcome, trajectory, depth);
  const int signal = received_signal();
  if (shown) serve_until_interrupted(shown->viewer);
  if (!useful || (saver && !saved) || end == RunEnd::kSourceFailed) return ExitCode::kBadInput;
  return exit_code(slam, signal, map ? folder.report() : folder.frames());
}

void print_options(const std::string& which) {
  if (which != "true" && which != "all")
    throw UsageError(fmt::format("--options: '{}' is not all; expected --options or --options=all", which));
  const bool all = which == "all";
  RunOptions options;
  fmt::print(
      "Options for --set key=value, with their defaults:\n{}",
      options_help(option_entries(options), all ? OptionSelection::kAll : OptionSelection::kDocumented));
  if (!all)
    fmt::print(
        "Expert options, among them those of sim:room (sim.*), are listed by kinloop run --options=all.\n");
}

}  // namespace

void add_run_command(CLI::App& app, ExitCode& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Map a sequence: trajectory, coloured map, report");
  add_run_arguments(*command, *arguments);
  command->callback([arguments, &exit_code] {
    if (!arguments->list_options.empty()) return print_options(arguments->list_options);
    if (arguments->sequence.empty())
      throw UsageError(
          "kinloop run: SEQUENCE is missing, for example: kinloop run sim:room -o out; see kinloop run "
          "--help");
    arguments->load_map = map_file_of(arguments->load_map);
    exit_code = run(*arguments);
  });
}

}  // namespace kinloop
