#include "apps/run/run_arguments.hpp"

#include "apps/run/run_viewer.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "session/source/source_filters.hpp"

namespace kinloop {

namespace {

/// What is saved and continued.
void add_map_arguments(CLI::App& command, RunArguments& arguments) {
  command.add_option("--save-map", arguments.save_map,
                     "file to save the map to (default: map.kinmap in the output folder)");
  command.add_option("--load-map", arguments.request.settings.load_map,
                     "map of an earlier run to continue: a map file or the folder of a run");
  CLI::Option* localize = command.add_flag(
      "--localize", arguments.request.settings.localize,
      "only localise in the map of --load-map; do not change the map. Writes only\n"
      "trajectory.txt, covariances.txt, live.txt, frames.txt and run.json; no cloud, report or map file");
  command
      .add_flag(
          "--report", arguments.report,
          "with --localize: also write the cloud of the map (map.ply), report.html and the other files\n"
          "of a run, which requires fusing the whole map")
      ->needs(localize);
  command
      .add_option("--autosave", arguments.autosave_s,
                  "interval between saves of the map during the run, s; 0 = only at the end")
      ->check(number(0, 1e6))
      ->capture_default_str();
  command
      .add_option("--memory", arguments.request.settings.memory_mib,
                  "memory for images, descriptors and patches of the map, MiB; the oldest beyond it are\n"
                  "kept in a temporary file (in TMPDIR); does not affect the results")
      ->check(whole_number(1, 1000000));
}

/// What the images are taken with, and which of them are used.
void add_input_arguments(CLI::App& command, RunRequest& request) {
  add_sequence_option(command, request.source.chosen);
  add_camera_options(command, request.camera);
  CLI::Option* camera = command.get_option("--camera");
  camera->description(camera->get_description() +
                      ".\nguess: the focal length that the images of a folder fit, if nobody knows it");
  command.add_option("--topics", request.source.topics,
                     "topics of a bag: COLOR,DEPTH[,CAMERA_INFO] (default: those of known drivers)");
  command
      .add_option("--depth-offset", request.source.depth_offset_s,
                  "seconds to add to the stamps of depth before images are paired, if the two cameras have\n"
                  "different clocks; a run warns of that and names the offset")
      ->option_text("SECONDS")
      ->check(number(-ShiftedDepthSource::kMaxOffset_s, ShiftedDepthSource::kMaxOffset_s));
  command.add_option("--every", request.source.every, "use only every n-th frame, beginning with the first")
      ->option_text("N")
      ->check(whole_number(1, ThinnedSource::kMaxStep));
  command.add_option("--mask", request.source.mask,
                     "image of the size of the colour images, black where they are to be ignored, such as\n"
                     "the robot that carries the camera; a run writes what it finds itself as mask.png.\n"
                     "For masks of single frames see docs/recordings.md");
}

/// A script whose variable is not set gives nothing.
std::string check_target(const std::string& target) {
  return target.empty() ? "'' is nothing to send to; give a file, a pipe, - (standard output), unix:PATH or "
                          "udp:HOST:PORT"
                        : "";
}

/// How much work is done at a time.
void add_speed_arguments(CLI::App& command, RunRequest& request) {
  command
      .add_option("--threads", request.settings.threads,
                  "number of threads, 0 = all; does not affect the results")
      ->check(whole_number(0, 1024));
  command
      .add_option(
          "--budget", request.settings.budget_percent,
          "percent of one core to keep the rate of a camera with, at 30 Hz: does less for each frame,\n"
          "which costs accuracy; --set prevails. See docs/tune.md")
      ->option_text("PERCENT")
      ->check(number(1, 10000));
  command
      .add_option("--pace", request.pace_hz,
                  "replay at this rate, Hz, like a live camera: late frames are dropped,\n"
                  "and background results are applied when ready (executor.mode=live)")
      ->check(number(0.1, 1000));
}

}  // namespace

void add_run_arguments(CLI::App& command, RunArguments& arguments) {
  command.add_option(
      "SEQUENCE", arguments.request.source.sequence,
      "a folder in TUM layout (rgb.txt, depth.txt, ...) or that of another dataset or app (see\n"
      "docs/recordings.md), an archive of one (.zip, .r3d, .7z, .tar, .tgz, ...), a .sens file, a bag\n"
      "(.bag of ROS 1 or the RealSense SDK, .mcap or .db3 of ROS 2 or their folder), a .mkv of the\n"
      "Azure Kinect, a .oni of OpenNI, kinect1, kinect2, openni2 (Xtion, Astra, Structure Core),\n"
      "realsense, orbbec or oak (live), frames from another program (-: standard input, or unix:PATH:\n"
      "a socket), or sim:room, the simulated Kinect (sim:room:7: another room)");
  command.add_option("-o,--output", arguments.output, "folder for the results")->capture_default_str();
  add_input_arguments(command, arguments.request);
  command.add_option("--vocabulary", arguments.request.settings.vocabulary,
                     "visual vocabulary from kinloop vocab train (default: built-in)");
  add_map_arguments(command, arguments);
  command.add_flag("--no-loop", arguments.request.settings.no_loop, "do not close loops");
  command
      .add_option("--solver", arguments.request.settings.solver,
                  "pose graph solver: auto, builtin, ceres, g2o")
      ->check(one_of(names_of<PoseGraphSolver>()));
  add_set_option(command, arguments.request.settings.assignments, "set an option, key=value; see --options");
  command.add_flag("--options", arguments.list_options,
                   "list the options of --set and exit; --options=all: list the expert options, too");
  add_speed_arguments(command, arguments.request);
  command.add_flag(
      "--no-remember", [&arguments](int64_t) { arguments.request.remember = false; },
      "do not use or update what earlier runs estimated of a live camera: its readout time and depth\n"
      "delay, kept for each serial number in ~/.local/share/kinloop/sensors");
  command.add_flag("--keep-doubtful", arguments.keep_doubtful,
                   "also write the poses of doubtful frames to trajectory.txt, and evaluate them");
  command
      .add_option("--poses-to", arguments.poses_to,
                  "send a JSON line with the pose of each frame as it is tracked to a file or a pipe, to\n"
                  "standard output (-), to the program that connects to unix:PATH, or to udp:HOST:PORT;\n"
                  "see docs/protocol.md")
      ->check(CLI::Validator(check_target, ""));
  command
      .add_option(
          "--trajectory", arguments.trajectory,
          "also write the trajectory to this file: .csv: a table, .kitti: KITTI format (refused if a frame\n"
          "has no pose), others: TUM format")
      ->option_text("FILE");
  add_frame_option(command, arguments.frame);
  add_up_option(command, arguments.request.settings.assignments);
  add_viewer_option(command, arguments.viewer);
  add_quiet_option(command, arguments.quiet);
  command.add_flag("--profile", arguments.profile, "print the CPU time of each module at the end");
  command.add_flag("-v,--verbose", arguments.verbose, "log every event")->excludes("--quiet");
  command.footer(
      "Examples:\n"
      "  kinloop run sim:room -o out\n"
      "  kinloop run rgbd_dataset_freiburg1_room -o room --set dense.voxel_m=0.005\n"
      "  kinloop run FOLDER --camera my_kinect.yaml --no-loop");
}

}  // namespace kinloop
