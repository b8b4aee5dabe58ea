#include "apps/run_arguments.hpp"

#include "apps/common_options.hpp"
#include "apps/show_run.hpp"

namespace kinloop {

void add_run_arguments(CLI::App& command, RunArguments& arguments) {
  command.add_option("SEQUENCE", arguments.sequence,
                     "a folder in TUM layout (rgb.txt, depth.txt, ...), a ROS .bag file, kinect1 or kinect2\n"
                     "(live), or sim:room, the simulated Kinect (sim:room:7 is another room)");
  command.add_option("-o,--output", arguments.output, "folder for the results")->capture_default_str();
  command.add_option(
      "--camera", arguments.camera,
      "camera.yaml to use, or freiburg1, freiburg2, freiburg3, icl; else camera.yaml in the folder, "
      "else by the folder's name");
  command.add_option("--topics", arguments.topics,
                     "of a bag: COLOR,DEPTH[,CAMERA_INFO], where they are not those of a known driver");
  command.add_option("--vocabulary", arguments.vocabulary,
                     "dictionary of visual words, from kinloop vocab train; else the one built in");
  command.add_option("--save-map", arguments.save_map,
                     "where to save the map, to go on with it later; else map.kinmap in the output folder");
  command.add_option("--load-map", arguments.load_map,
                     "the map of an earlier run to go on with: its file, or the folder of the run");
  CLI::Option* localize = command.add_flag(
      "--localize", arguments.localize,
      "only say where the frames are in the map of --load-map; the map stays as it is. Writes\n"
      "trajectory.txt, frames.txt and run.json alone; no cloud, no report, no map file");
  command
      .add_flag(
          "--report", arguments.report,
          "with --localize: also write the cloud of the map (map.ply), report.html and the other files\n"
          "of a run; this takes the time to fuse the whole map")
      ->needs(localize);
  command
      .add_option("--autosave", arguments.autosave_s,
                  "seconds after which the map is saved again while the run goes on; 0 = at the end only")
      ->check(number(0, 1e6))
      ->capture_default_str();
  command.add_flag("--no-loop", arguments.no_loop, "do not close loops");
  command.add_option("--solver", arguments.solver, "who solves the pose graph: auto, builtin, ceres, g2o")
      ->check(one_of({"auto", "builtin", "ceres", "g2o"}));
  add_set_option(command, arguments.assignments, "change an option, key=value; see --options");
  command.add_flag("--options", arguments.list_options, "list all options of --set and exit");
  command
      .add_option("--threads", arguments.threads,
                  "threads of parallel work, 0 = all; the results are the same")
      ->check(whole_number(0, 1024));
  command
      .add_option(
          "--pace", arguments.pace_hz,
          "replay at this many frames a second, as a live camera: frames not taken in time are lost,\n"
          "and slow work is applied when it is ready (executor.mode=live)")
      ->check(number(0.1, 1000));
  add_frame_option(command, arguments.frame);
  add_viewer_option(command, arguments.viewer);
  add_quiet_option(command, arguments.quiet);
  command.add_flag("-v,--verbose", arguments.verbose, "print what happens, a line each")->excludes("--quiet");
  command.footer(
      "Examples:\n"
      "  kinloop run sim:room -o out\n"
      "  kinloop run rgbd_dataset_freiburg1_room -o room --set dense.voxel_m=0.005\n"
      "  kinloop run FOLDER --camera my_kinect.yaml --no-loop");
}

}  // namespace kinloop
