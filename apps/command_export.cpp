// kinloop export: writes a map in formats that other programs read.

#include <fmt/format.h>

#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "apps/shared/map_store.hpp"
#include "apps/shared/progress_bar.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/base/writable_check.hpp"
#include "kinloop/dense/occupancy.hpp"
#include "kinloop/io/grid_file.hpp"
#include "kinloop/io/point_cloud/pcd.hpp"
#include "kinloop/io/point_cloud/ply.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/optimize/pose_graph/g2o_file.hpp"

namespace kinloop {
namespace {

struct ExportArguments {
  std::filesystem::path map, poses;
  std::filesystem::path cloud, octomap, grid, trajectory, keyframes, graph;
  std::string frame = "z-up";
  size_t session = 0;
  std::vector<std::string> assignments;
  int threads = hardware_threads();
  bool quiet = false;

  /// The files to write.
  [[nodiscard]] std::vector<std::filesystem::path> outputs() const {
    std::vector<std::filesystem::path> paths{cloud, octomap, grid, trajectory, keyframes, graph};
    std::erase(paths, std::filesystem::path());
    return paths;
  }

  /// Throws before any work is done if a result could not be written.
  void require_writable() const {
    for (const auto& path : outputs()) require_writable_file(path);
  }
};

void write_cloud(const ExportArguments& arguments, OpenMap& open, const Progress& progress) {
  const ColoredCloud cloud = open.cloud(arguments.session, arguments.threads, progress);
  const FileFrame frame =
      file_frame(arguments.frame, open.up(arguments.session), open.views(arguments.session));
  if (arguments.cloud.extension() == ".pcd") return write_pcd(arguments.cloud, cloud, frame);
  write_ply(arguments.cloud, cloud, frame);
}

void require_extension(const char* option, const std::filesystem::path& path, const char* a, const char* b) {
  if (path.empty() || path.extension() == a || path.extension() == b) return;
  throw UsageError(fmt::format("{} {}: the name must end in {}{}{}", option, path.string(), a,
                               std::string_view(a) == b ? "" : " or ", std::string_view(a) == b ? "" : b));
}

void write_occupancy(const ExportArguments& arguments, OpenMap& open, const Progress& progress) {
  const ImageStore& images = open.recorder.images();
  const auto views = open.views(arguments.session);
  const PinholeCamera& camera = open.saved.camera.color;
  const OccupancyOptions& options = open.options.occupancy;
  const UpEstimate up = open.up(arguments.session);
  if (up.source == UpSource::kCamera) {
    log::warn(
        "the surfaces do not determine the up direction; using the mean of the cameras' up axes: check that "
        "floors are level");
  }
  const Floor floor = find_floor(images, views, camera, up.direction, options);
  const OccupancyMap occupancy(images, views, camera, floor, options, progress);
  if (!arguments.octomap.empty()) {
    const bool full = arguments.octomap.extension() == ".ot";
    write_file(arguments.octomap, full ? occupancy.serialize_full() : occupancy.serialize_binary());
  }
  if (!arguments.grid.empty()) write_grid(arguments.grid, occupancy.grid());
}

void run_export(const ExportArguments& arguments) {
  if (arguments.outputs().empty())
    throw UsageError(
        "export: nothing to write; specify one or more of --cloud, --octomap, --grid, --trajectory, "
        "--keyframes, "
        "--graph");
  require_extension("--cloud", arguments.cloud, ".ply", ".pcd");
  require_extension("--octomap", arguments.octomap, ".bt", ".ot");
  require_extension("--grid", arguments.grid, ".pgm", ".pgm");
  const auto map = map_file_of(arguments.map);
  require_different_file("--trajectory", arguments.trajectory, map);
  require_different_file("--keyframes", arguments.keyframes, map);
  require_different_file("--graph", arguments.graph, map);
  arguments.require_writable();
  OpenMap open = open_map(arguments.map, arguments.assignments, arguments.poses);
  const Progress progress = make_progress_bar(arguments.quiet);
  const auto session = open.session_log(arguments.session);
  if (!arguments.trajectory.empty()) {
    write_tum_trajectory(arguments.trajectory, trajectory_of(session, open.map));
  }
  if (!arguments.keyframes.empty()) {
    write_tum_trajectory(arguments.keyframes,
                         keyframe_trajectory(open.map, open.component(arguments.session)));
  }
  if (!arguments.graph.empty()) {
    write_g2o(arguments.graph, {make_pose_graph(open.map, open.options.slam.loop), {}, true, {}});
  }
  if (!arguments.cloud.empty()) write_cloud(arguments, open, progress);
  if (!arguments.octomap.empty() || !arguments.grid.empty()) write_occupancy(arguments, open, progress);
  if (arguments.quiet) return;
  for (const auto& path : arguments.outputs()) fmt::print("written: {}\n", path.string());
}

}  // namespace

void add_export_command(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write a map in formats that other programs read");
  add_map_argument(*command, arguments->map);
  command->add_option("--cloud", arguments->cloud, "coloured cloud, FILE.ply or FILE.pcd");
  command->add_option("--octomap", arguments->octomap,
                      "free and occupied space, z up: FILE.bt, or FILE.ot with probabilities");
  command->add_option("--grid", arguments->grid,
                      "occupancy grid of the floor for ROS map_server: FILE.pgm and FILE.yaml");
  command->add_option("--trajectory", arguments->trajectory, "pose of every frame of a session (TUM format)");
  command->add_option("--keyframes", arguments->keyframes, "pose of every keyframe (TUM format)");
  command->add_option("--graph", arguments->graph, "pose graph, FILE.g2o");
  add_poses_option(*command, arguments->poses);
  command->add_option(
      "--session", arguments->session,
      "session number, counted from 1; 0 = the last; of a disconnected map, its component is written");
  add_frame_option(*command, arguments->frame);
  add_set_option(*command, arguments->assignments);
  add_threads_option(*command, arguments->threads);
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { run_export(*arguments); });
}

}  // namespace kinloop
