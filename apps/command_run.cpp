// kinloop run: a sequence in, a trajectory, a map and a report out.

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "apps/commands.hpp"
#include "apps/dense_recorder.hpp"
#include "apps/frame_recorder.hpp"
#include "apps/interrupt.hpp"
#include "apps/loop_pictures.hpp"
#include "apps/memory.hpp"
#include "apps/open_source.hpp"
#include "apps/progress_bar.hpp"
#include "apps/report_file.hpp"
#include "apps/run_summary.hpp"
#include "apps/show_run.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/optimize/g2o_file.hpp"
#include "kinloop/output/run_folder.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/place/vocabulary_file.hpp"
#include "kinloop/sensor/camera_file.hpp"
#include "kinloop/sensor/paced_source.hpp"
#include "kinloop/slam/frame_pipeline.hpp"

namespace kinloop {
namespace {

struct RunArguments {
  std::string sequence;
  std::filesystem::path output = "out";
  std::string camera;
  std::string topics;
  std::string solver = "auto";
  std::string vocabulary;
  bool no_loop = false;
  bool list_options = false;
  bool quiet = false;
  int threads = 0;
  std::string viewer;  // [ADDRESS:]PORT; empty: none
  double pace_hz = 0;
  std::vector<std::string> assignments;
};

RunOptions options_of(const RunArguments& arguments, int threads) {
  RunOptions options;
  options.slam.full.threads = threads;
  if (arguments.pace_hz > 0 || is_live(arguments.sequence)) options.slam.executor.mode = "live";
  options = with_assignments(options, arguments.assignments);
  if (arguments.no_loop) options.slam.loop.enabled = false;
  if (arguments.solver != "auto") options.slam.loop.pose_graph.solver = arguments.solver;
  if (!pose_graph_solver_available(options.slam.loop.pose_graph.solver)) {
    throw UsageError(fmt::format("--solver {}: not in this build; see kinloop --version", arguments.solver));
  }
  return options;
}

/// The dictionary that goes with the features. It cannot be told from a file what kind it was trained on.
Vocabulary vocabulary_of(const RunArguments& arguments, const FeatureOptions& features) {
  if (!arguments.vocabulary.empty()) return read_vocabulary(arguments.vocabulary);
  if (features.kind != "orb") {
    throw UsageError(fmt::format(
        "features.kind={0}: the dictionary built in is of ORB; train one with `kinloop vocab train IMAGES... "
        "--feature {0} -o FILE` and give it with --vocabulary FILE",
        features.kind));
  }
  return load_default_vocabulary();
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

/// Feeds all frames, each when `leave` was given; false when Ctrl-C ended it early.
bool process_all(FrameSource& source, Slam& slam, const Progress& progress,
                 const std::function<void()>& leave) {
  FramePipeline pipeline(source, slam);
  size_t done = 0;
  while (const auto frame = pipeline.next()) {
    if (leave) leave();
    slam.process(*frame);
    report(progress, "mapping", ++done, source.info().frames);
    if (interrupted()) return false;
  }
  return true;
}

/// Lost at the end, or never found: what the exit code tells scripts.
bool lost_for_good(const FrameLog& log, const Map& map, uint32_t component) {
  return log.empty() || !tracked_in(component, log.back(), map);
}

void warn_of_skipped(const FrameSource& source) {
  const auto skipped = source.skipped();
  if (skipped.empty()) return;
  log::warn("{} frames were skipped; the first: {}: {}", skipped.size(), skipped.front().name,
            skipped.front().reason);
}

ExitCode run(const RunArguments& arguments) {
  const Stopwatch watch;
  const int threads = arguments.threads > 0 ? arguments.threads : hardware_threads();
  const RunOptions options = options_of(arguments, threads);
  const RunFolder folder(arguments.output);
  auto source = open_source(request_of(arguments, options, threads));
  const PacedSource* paced = nullptr;
  if (arguments.pace_hz > 0) {
    auto pacing = std::make_unique<PacedSource>(std::move(source), arguments.pace_hz);
    paced = pacing.get();
    source = std::move(pacing);
  }
  const Progress progress = make_progress_bar(arguments.quiet);

  Slam slam(source->camera(), options.slam, vocabulary_of(arguments, options.slam.features));
  DenseRecorder recorder(source->camera(), options.dense);
  FrameRecorder frames;
  slam.listen(recorder);
  slam.listen(frames);
  catch_interrupts();
  const auto save_now = [&] { save_map(folder, slam, recorder, threads); };
  const auto shown = show_run(arguments.viewer, *source, options.viewer, slam, save_now);
  const bool complete = process_all(*source, slam, progress, shown ? shown->leave : nullptr);
  if (!complete) log::warn("interrupted: finishing with the {} frames there are", slam.log().size());
  if (shown) shown->viewer.tell("final adjustment");
  const Trajectory trajectory = slam.finish(progress);
  if (shown) shown->viewer.finish(slam.log(), slam.map());
  return_freed_memory();
  const ColoredCloud cloud = recorder.fuse(slam.log(), slam.map(), threads, progress);
  return_freed_memory();
  warn_of_skipped(*source);

  const Trajectory& truth = source->info().ground_truth;
  const auto evaluation = truth.empty() ? std::nullopt : evaluate(trajectory, truth);
  const auto summary = run_summary({*source, slam, options, evaluation, cloud.size(), watch.wall_s(), threads,
                                    !complete, paced != nullptr ? paced->dropped() : 0});
  const uint32_t component = main_component(slam.log(), slam.map());
  write_run_files(folder, {trajectory, keyframe_trajectory(slam.map(), component), truth, cloud, summary});
  write_camera_file(folder.camera(), calibrated_camera(source->camera(), slam.sensor()));
  write_g2o(folder.graph(), {make_pose_graph(slam.map(), options.slam.loop), {}, true, {}});
  write_frame_table(folder.frames(), frames.table(slam.times()));
  write_loop_pictures(folder, slam.map(), recorder);
  write_report(folder);
  if (!arguments.quiet) {
    fmt::print("{}results    {} (trajectory.txt, map.ply, report.html)\n", summary_text(summary),
               folder.path().string());
  }
  if (shown) stay_open(shown->viewer);
  if (lost_for_good(slam.log(), slam.map(), component)) {
    log::error("tracking was lost and its place not recognised again; see {}",
               (arguments.output / "report.html").string());
    return ExitCode::kTrackingLost;
  }
  return ExitCode::kDone;
}

void print_options() {
  RunOptions options;
  fmt::print("Options for --set key=value, with their defaults:\n{}", options_help(option_entries(options)));
}

}  // namespace

void add_run_command(CLI::App& app, ExitCode& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Map a sequence: trajectory, coloured map, report");
  command->add_option(
      "SEQUENCE", arguments->sequence,
      "a folder in TUM layout (rgb.txt, depth.txt, ...), a ROS .bag file, kinect1 or kinect2\n"
      "(live), or sim:room, the simulated Kinect (sim:room:7 is another room)");
  command->add_option("-o,--output", arguments->output, "folder for the results")->capture_default_str();
  command->add_option(
      "--camera", arguments->camera,
      "camera.yaml to use, or freiburg1, freiburg2, freiburg3, icl; else camera.yaml in the folder, "
      "else by the folder's name");
  command->add_option("--topics", arguments->topics,
                      "of a bag: COLOR,DEPTH[,CAMERA_INFO], where they are not those of a known driver");
  command->add_option("--vocabulary", arguments->vocabulary,
                      "dictionary of visual words, from kinloop vocab train; else the one built in");
  command->add_flag("--no-loop", arguments->no_loop, "do not close loops");
  command->add_option("--solver", arguments->solver, "who solves the pose graph: auto, builtin, ceres, g2o")
      ->check(CLI::IsMember({"auto", "builtin", "ceres", "g2o"}));
  command->add_option("--set", arguments->assignments, "change an option, key=value; see --options")
      ->allow_extra_args(false);
  command->add_flag("--options", arguments->list_options, "list all options of --set and exit");
  command
      ->add_option("--threads", arguments->threads,
                   "threads of parallel work, 0 = all; the results are the same")
      ->check(CLI::Range(0, 1024));
  command
      ->add_option(
          "--pace", arguments->pace_hz,
          "replay at this many frames a second, as a live camera: frames not taken in time are lost,\n"
          "and slow work is applied when it is ready (executor.mode=live)")
      ->check(CLI::Range(0.1, 1000.0));
  add_viewer_option(*command, arguments->viewer);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but warnings and errors");
  command->footer(
      "Examples:\n"
      "  kinloop run sim:room -o out\n"
      "  kinloop run rgbd_dataset_freiburg1_room -o room --set dense.voxel_m=0.005\n"
      "  kinloop run FOLDER --camera my_kinect.yaml --no-loop");
  command->callback([arguments, &exit_code] {
    if (arguments->list_options) return print_options();
    if (arguments->sequence.empty()) throw UsageError("run: which SEQUENCE? See kinloop run --help");
    exit_code = run(*arguments);
  });
}

}  // namespace kinloop
