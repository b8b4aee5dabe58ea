// kinloop run: maps a sequence and writes trajectory, map and report.

#include <functional>
#include <memory>

#include <fmt/format.h>

#include "apps/live_poses/pose_sender.hpp"
#include "apps/run/run_arguments.hpp"
#include "apps/run/run_logger.hpp"
#include "apps/run/run_output.hpp"
#include "apps/run/run_viewer.hpp"
#include "apps/run/summary/run_warnings.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/terminal/failure.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "drivers/datasets/camera_selection.hpp"
#include "drivers/datasets/sequences_below.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/io/run_folder.hpp"
#include "session/plan/run_plan.hpp"
#include "session/session.hpp"
#include "session/store/command_files.hpp"

namespace kinloop {
namespace {

/// Returns the camera files above the folder of a sequence that may be read if it has none itself; none of a
/// run's.
std::vector<std::filesystem::path> cameras_above(const std::filesystem::path& folder) {
  const auto above = std::filesystem::absolute(folder / "").lexically_normal().parent_path().parent_path();
  std::error_code absent;
  if (!std::filesystem::is_directory(folder, absent) || preset_of_folder(folder) ||
      std::filesystem::exists(folder / "camera.yaml", absent) ||
      std::filesystem::exists(above / "run.json", absent))
    return {};
  return {above / "camera.yaml", above / "cam_params.json", above / "camera-intrinsics.txt"};
}

/// What the run reads and writes.
CommandFiles command_files(const RunArguments& arguments) {
  const auto& [source, camera, pace_hz, remember, settings] = arguments.request;
  const auto map = settings.load_map.empty() ? settings.load_map : map_file_of(settings.load_map);
  CommandFiles files{.inputs = {camera.camera, source.mask, settings.vocabulary, map},
                     .outputs = {{"--trajectory", arguments.trajectory}, {"--save-map", arguments.save_map}},
                     .results = {{{"-o", arguments.output}, run_file_names()}}};
  add_sequence_input(files, source.sequence, source.chosen);
  if (camera.camera.empty() && camera.intrinsics.empty()) {
    for (auto& above : cameras_above(sequence_folder(source.sequence, source.chosen)))
      files.inputs.push_back(std::move(above));
  }
  if (is_file_target(arguments.poses_to)) files.outputs.push_back({"--poses-to", arguments.poses_to});
  return files;
}

/// Throws UsageError if arguments contradict each other, or a result would replace what the run reads.
void check_arguments(const RunArguments& arguments) {
  const RunRequest& request = arguments.request;
  if (request.source.sequence.empty())
    throw UsageError(
        "kinloop run: SEQUENCE is missing, for example: kinloop run sim:room -o out; see kinloop run "
        "--help");
  if (request.settings.localize && request.settings.load_map.empty())
    throw UsageError("--localize requires --load-map FILE");
  if (request.settings.localize && !arguments.save_map.empty())
    throw UsageError("--localize does not change the map: it cannot be combined with --save-map");
  check_line_target(arguments.poses_to);
  require_outputs(command_files(arguments));
}

/// How the frames ended.
enum class RunEnd { kComplete, kInterrupted, kSourceFailed };

/// What happens beside each frame; the functions may be empty.
struct FrameHooks {
  Progress progress;
  std::function<void()> wait_until_resumed;            ///< waits while the run is paused
  std::function<void(const TrackedFrame&)> send_pose;  ///< as soon as it is known
};

/// Processes all frames. A source that fails after its first frame ends the run like Ctrl-C does: what has
/// been mapped is kept. Not so a fault of the program.
RunEnd process_all(Session& session, RunOutput& output, const FrameHooks& hooks) {
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
    if (hooks.wait_until_resumed) hooks.wait_until_resumed();
    const TrackedFrame tracked = session.track(*frame);
    output.record_pose(tracked);
    if (hooks.send_pose) hooks.send_pose(tracked);
    const TrackedFrame mapped = session.update_map();
    ++done;
    if (hooks.progress)
      hooks.progress({"mapping", done, frames, progress_note(mapped, session.slam().map())});
    output.save_if_due();
    if (interrupted()) break;
  }
  if (failed) return RunEnd::kSourceFailed;
  if (!interrupted()) return RunEnd::kComplete;  // interrupted while the source was silent, too
  // A second Ctrl-C ends the program before the map is finished.
  output.try_save_map_file();
  log::warn("interrupted: finishing with {} frames", session.slam().session_log().size());
  return RunEnd::kInterrupted;
}

/// Adds the map to continue to the session, and its images if they are recorded.
void continue_map(ContinuedMap& start, Session& session, bool with_images) {
  const uint32_t shift = session.add_map(std::move(start.saved));
  if (with_images) start.restore_images(shift, session.recorder());
}

/// Prints the summary, and the profile if asked for; on standard error if standard output carries poses.
void print_summary(const RunArguments& arguments, const nlohmann::json& summary, const RunOutput& output) {
  std::FILE* stream = is_standard_output_target(arguments.poses_to) ? stderr : stdout;
  const char* files = output.poses_only() ? "trajectory.txt; use --report for cloud and report"
                                          : "trajectory.txt, map.ply, report.html";
  const std::string folder = output.folder().path().string();
  if (!arguments.quiet)
    print_text(fmt::format("{}results    {} ({})\n{}\n", summary_text(summary), folder, files,
                           quality_text(summary)),
               stream);
  if (arguments.profile) print_text(profile_text(summary), stream);
}

/// Returns what sends the poses, or null.
std::unique_ptr<PoseSender> open_pose_sender(const std::string& target) {
  return target.empty() ? nullptr : std::make_unique<PoseSender>(target);
}

ExitCode run(const RunArguments& arguments) {
  const Stopwatch watch;
  RunPlan plan = plan_run(arguments.request);
  if (!arguments.quiet) log_recognition(*plan.source);
  const Progress progress = arguments.verbose ? make_stage_logger() : make_progress_bar(arguments.quiet);
  const bool record_images = !arguments.poses_only();
  Session session(*plan.source, {plan.options.slam, plan.options.dense, record_images, plan.threads},
                  plan.camera, std::move(plan.vocabulary));
  RunOutput output(arguments, plan, session);
  auto poses = open_pose_sender(arguments.poses_to);
  RunLogger logger;
  if (arguments.verbose) {
    log_run_start(*plan.source, plan.threads);
    session.add_listener(logger);
  }
  if (plan.start) continue_map(*plan.start, session, record_images);
  install_interrupt_handler();
  const auto shown =
      start_run_viewer(arguments.viewer, plan.options.viewer, session, [&] { output.save_now(); });
  const ElapsedTime startup{watch.wall_s(), process_cpu_s()};
  FrameHooks hooks{progress, shown ? shown->wait_until_resumed : nullptr, nullptr};
  if (poses) hooks.send_pose = [&](const TrackedFrame& frame) { poses->send(frame, session.slam().map()); };
  const RunEnd end = process_all(session, output, hooks);
  const bool sent = !poses || poses->finish();
  poses.reset();  // the reader sees the end
  if (shown) {
    shown->viewer.set_hints({});  // too late for advice
    shown->viewer.set_stage("final bundle adjustment");
  }
  session.finish(progress);
  if (plan.memory) plan.memory->remember(plan.camera, session.slam().sensor_estimate());
  if (shown) show_warnings(shown->viewer, session.input());
  if (shown) shown->viewer.finish(session.slam().session_log(), session.slam().map());
  const auto summary = output.write({watch, startup, end == RunEnd::kComplete}, progress);
  print_summary(arguments, summary, output);
  const bool useful = output.check();
  const int signal = received_signal();
  if (shown) serve_until_interrupted(shown->viewer);
  if (!useful || !sent || end == RunEnd::kSourceFailed) return ExitCode::kBadInput;
  return exit_code(session.slam(), signal, output.details());
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
  arguments->request.source.stop = interrupted;
  command->callback([arguments, &exit_code] {
    if (!arguments->list_options.empty()) return print_options(arguments->list_options);
    check_arguments(*arguments);
    exit_code = run(*arguments);
  });
}

}  // namespace kinloop
