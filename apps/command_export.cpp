// kinloop export: writes a map in formats that other programs read.

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/files/rerun_export.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "dense/files/pcd.hpp"
#include "dense/files/ply.hpp"
#include "dense/occupancy.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "session/store/command_files.hpp"
#include "session/store/export_sparse_model.hpp"
#include "session/store/map_store.hpp"
#include "tools/export/g2o/g2o_file.hpp"
#include "tools/export/grid_file.hpp"
#include "tools/export/las.hpp"
#include "tools/export/mcap/recording.hpp"
#include "tools/export/trajectory_writer.hpp"

namespace kinloop {
namespace {

struct MapRecordingRequest {
  std::filesystem::path file;
  std::string frame;
  size_t session = 0;
  int threads = 1;
};

/// Returns those of `views` that belong to the session, in order of time.
std::vector<StampedImage> session_images(std::span<const LoggedFrame> session, const OpenMap& open,
                                         std::span<const PosedImage> views) {
  std::unordered_map<FrameId, int64_t> stamp_of;
  for (const LoggedFrame& entry : session) stamp_of.emplace(entry.id, entry.stamp_ns);
  std::vector<StampedImage> images;
  for (const PosedImage& view : views) {
    const auto stamp = stamp_of.find(open.recorder.frame_of_image(view.image));
    if (stamp != stamp_of.end()) images.push_back({stamp->second, view.image});
  }
  std::stable_sort(images.begin(), images.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return images;
}

/// Writes the poses and images of the session, and the cloud of its component.
void export_map_recording(const MapRecordingRequest& request, OpenMap& open, const Progress& progress) {
  const auto session = open.session_log(request.session);
  const auto views = open.views(request.session);
  MapRecording recording;
  recording.trajectory = open.poses.empty() ? trajectory_of(session, open.map) : open.poses;
  recording.images = session_images(session, open, views);
  recording.cloud = open.cloud(request.session, request.threads, progress);
  recording.camera = open.dense_camera().color;
  recording.frame = file_frame(request.frame, open.up(request.session), views);
  write_map_recording(request.file, recording,
                      [&](size_t image) { return open.recorder.images().encoded(image).color; });
}

struct ExportArguments {
  std::filesystem::path map, poses;
  std::filesystem::path cloud, octomap, grid, trajectory, keyframes, graph, mcap;
  std::filesystem::path colmap, nerfstudio;  ///< folders
  std::filesystem::path rrd;
  size_t images = 0, points = 0;  ///< see SparseModelRequest
  std::string recording;
  std::string frame = "z-up";
  size_t session = 0;
  std::vector<std::string> assignments;
  int threads = hardware_threads();
  bool quiet = false;

  /// The files to write.
  [[nodiscard]] std::vector<std::filesystem::path> files() const {
    return given({cloud, octomap, grid, trajectory, keyframes, graph, mcap, rrd});
  }

  /// The folders to write into.
  [[nodiscard]] std::vector<std::filesystem::path> folders() const { return given({colmap, nerfstudio}); }

  [[nodiscard]] bool wants_nothing() const { return files().empty() && folders().empty(); }

 private:
  static std::vector<std::filesystem::path> given(std::vector<std::filesystem::path> paths) {
    std::erase(paths, std::filesystem::path());
    return paths;
  }
};

void write_cloud(const ExportArguments& arguments, OpenMap& open, const Progress& progress) {
  const auto views = open.views(arguments.session);
  require_images(views.size(), arguments.map);
  const ColoredCloud cloud = open.cloud(arguments.session, arguments.threads, progress);
  const FileFrame frame = file_frame(arguments.frame, open.up(arguments.session), views);
  if (arguments.cloud.extension() == ".pcd") return write_pcd(arguments.cloud, cloud, frame);
  if (arguments.cloud.extension() == ".las") return write_las(arguments.cloud, cloud, frame);
  write_ply(arguments.cloud, cloud, frame);
}

void require_extension(const char* option, const std::filesystem::path& path,
                       const std::vector<std::string>& extensions) {
  const auto found = std::find(extensions.begin(), extensions.end(), path.extension().string());
  if (path.empty() || found != extensions.end()) return;
  std::string list = extensions.front();
  for (size_t i = 1; i < extensions.size(); ++i)
    list += (i + 1 < extensions.size() ? ", " : " or ") + extensions[i];
  throw UsageError(fmt::format("{} {}: the name must end in {}", option, path.string(), list));
}

/// Writes the poses of the session and those of its keyframes, where they are asked for.
void write_trajectories(const ExportArguments& arguments, const OpenMap& open) {
  const auto session = open.session_log(arguments.session);
  if (!arguments.trajectory.empty()) {
    const Trajectory poses = trajectory_of(session, open.map);
    require_pose_of_each_frame(arguments.trajectory, poses.size(), session.size());
    write_trajectory_file(arguments.trajectory, poses,
                          note_on_doubtful_poses(session, open.map, DoubtfulPoses::kLeftOut));
  }
  if (!arguments.keyframes.empty())
    write_trajectory_file(arguments.keyframes,
                          keyframe_trajectory(open.map, open.component(arguments.session)));
}

void write_occupancy(const ExportArguments& arguments, OpenMap& open, const Progress& progress) {
  const ImageStore& images = open.recorder.images();
  const auto views = open.views(arguments.session);
  require_images(views.size(), arguments.map);
  const PinholeCamera& camera = open.saved.camera.color;
  const OccupancyOptions& options = open.options.occupancy;
  const UpEstimate up = open.up(arguments.session);
  if (up.source == UpSource::kCamera) {
    log::warn(
        "the surfaces do not determine the up direction; using the mean of the cameras' up axes: check that "
        "floors are level, or use --up X,Y,Z");
  }
  const Floor floor = find_floor(images, views, camera, up.direction, options);
  const OccupancyMap occupancy(images, views, camera, floor, options, progress);
  if (!arguments.octomap.empty()) {
    const bool full = arguments.octomap.extension() == ".ot";
    write_file(arguments.octomap, full ? occupancy.serialize_full() : occupancy.serialize_binary());
  }
  if (!arguments.grid.empty()) write_grid(arguments.grid, occupancy.grid());
}

/// What the command reads and writes.
CommandFiles command_files(const ExportArguments& a) {
  std::filesystem::path description = a.grid;
  if (!a.grid.empty()) description.replace_extension(".yaml");
  CommandFiles files{.inputs = {map_file_of(a.map), a.poses},
                     .outputs = {{"--cloud", a.cloud},
                                 {"--octomap", a.octomap},
                                 {"--grid", a.grid},
                                 {"--grid", description},
                                 {"--trajectory", a.trajectory},
                                 {"--keyframes", a.keyframes},
                                 {"--graph", a.graph},
                                 {"--mcap", a.mcap},
                                 {"--rrd", a.rrd}},
                     .results = {{{"--colmap", a.colmap},
                                  {"sparse/0/cameras.txt", "sparse/0/images.txt", "sparse/0/points3D.txt"}},
                                 {{"--nerfstudio", a.nerfstudio}, {"transforms.json"}}}};
  if (!a.recording.empty()) add_sequence_input(files, a.recording);
  return files;
}

/// Throws before any work is done if the arguments make no sense or a result could not be written.
void check(const ExportArguments& arguments) {
  if (arguments.wants_nothing())
    throw UsageError(
        "export: nothing to write; specify one or more of --cloud, --octomap, --grid, --trajectory, "
        "--keyframes, --graph, --colmap, --nerfstudio, --mcap, --rrd");
  require_extension("--cloud", arguments.cloud, {".ply", ".pcd", ".las"});
  require_extension("--octomap", arguments.octomap, {".bt", ".ot"});
  require_extension("--grid", arguments.grid, {".pgm"});
  require_extension("--mcap", arguments.mcap, {".mcap"});
  require_extension("--rrd", arguments.rrd, {".rrd"});
  if (is_kitti_name(arguments.keyframes))
    throw UsageError(
        fmt::format("--keyframes {}: KITTI format numbers frames, keyframes need time stamps; give a name "
                    "that ends in .txt or .csv",
                    arguments.keyframes.string()));
  if (arguments.folders().empty() && arguments.points > 0)
    throw UsageError("--points is for --colmap and --nerfstudio; give one of them");
  if (arguments.folders().empty() && arguments.rrd.empty() &&
      (arguments.images > 0 || !arguments.recording.empty()))
    throw UsageError("--images and --recording are for --colmap, --nerfstudio and --rrd; give one of them");
  require_outputs(command_files(arguments));
  for (const auto& folder : arguments.folders()) require_writable_folder(folder);
  if (!arguments.rrd.empty()) require_rerun();
}

/// Throws UsageError if an output would replace a file of the recording that the map names.
void check_recording(const ExportArguments& a, const OpenMap& open) {
  if (a.images == 0 || !a.recording.empty() || open.saved.sessions.empty()) return;
  CommandFiles files = command_files(a);
  add_sequence_input(files, open.saved.sessions[open.session_index(a.session)].input);
  require_outputs(files);
}

/// Writes what shows the images of the map, and more of its recording.
void write_images(const ExportArguments& a, OpenMap& open, const Progress& progress) {
  const bool with_cloud = !a.rrd.empty() || a.points > 0;
  const FileCloud file = file_cloud({a.frame, a.session, a.threads, with_cloud}, open, progress);
  if (!a.rrd.empty())
    export_rerun(a.rrd, {a.map, a.session, a.threads, a.images, a.recording}, file, open, progress);
  if (!a.folders().empty())
    export_sparse_model(
        {a.map, a.colmap, a.nerfstudio, a.session, a.threads, a.images, a.points, a.recording}, file, open,
        progress);
}

void run_export(const ExportArguments& arguments) {
  check(arguments);
  install_interrupt_handler();
  OpenMap open = open_map(arguments.map, arguments.assignments, arguments.poses);
  check_recording(arguments, open);
  const Progress progress = interruptible(make_progress_bar(arguments.quiet));
  write_trajectories(arguments, open);
  if (!arguments.graph.empty()) {
    write_g2o(arguments.graph, {make_pose_graph(open.map, open.options.slam.loop), {}, true, {}});
  }
  if (!arguments.cloud.empty()) write_cloud(arguments, open, progress);
  if (!arguments.octomap.empty() || !arguments.grid.empty()) write_occupancy(arguments, open, progress);
  if (!arguments.mcap.empty()) {
    export_map_recording({arguments.mcap, arguments.frame, arguments.session, arguments.threads}, open,
                         progress);
  }
  if (!arguments.rrd.empty() || !arguments.folders().empty())
    write_images(arguments, open, progress);  // last: it adds images to the map
  if (arguments.quiet) return;
  // One of the files may be standard output.
  const auto files = arguments.files();
  std::FILE* to = std::any_of(files.begin(), files.end(), is_standard_output) ? stderr : stdout;
  for (const auto& path : files) print_text(fmt::format("written: {}\n", path.string()), to);
  for (const auto& path : arguments.folders()) print_text(fmt::format("written: {}\n", path.string()), to);
}

}  // namespace

void add_export_command(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write a map in formats that other programs read");
  add_map_argument(*command, arguments->map);
  command->add_option("--cloud", arguments->cloud, "coloured cloud, FILE.ply, FILE.pcd or FILE.las");
  command->add_option("--octomap", arguments->octomap,
                      "free and occupied space, z up: FILE.bt, or FILE.ot with probabilities");
  command->add_option("--grid", arguments->grid,
                      "occupancy grid of the floor for ROS map_server: FILE.pgm and FILE.yaml");
  command->add_option("--trajectory", arguments->trajectory,
                      "pose of every frame of a session (TUM format; FILE.csv: fields of nav_msgs/Path)");
  command->add_option("--keyframes", arguments->keyframes, "pose of every keyframe, in the same formats");
  command->add_option("--graph", arguments->graph, "pose graph, FILE.g2o");
  command->add_option("--colmap", arguments->colmap,
                      "folder for a COLMAP text model: undistorted images, cameras, points and tracks");
  command->add_option("--nerfstudio", arguments->nerfstudio,
                      "folder for transforms.json (Nerfstudio): undistorted images, depth, poses");
  constexpr int kMostImages = 1'000'000, kMostPoints = 100'000'000;
  command
      ->add_option(
          "--images", arguments->images,
          "with --colmap, --nerfstudio or --rrd: at least so many images; those that the map does not hold "
          "are read from its recording (default: those of the map)")
      ->check(whole_number(1, kMostImages));
  command
      ->add_option("--points", arguments->points,
                   "with --colmap or --nerfstudio: so many points of the cloud, in addition to the landmarks")
      ->check(whole_number(1, kMostPoints));
  command->add_option("--recording", arguments->recording,
                      "with --images: the recording, if it is not where the map says");
  command->add_option("--mcap", arguments->mcap,
                      "recording for Foxglove: poses and images of a session, cloud; FILE.mcap");
  command->add_option("--rrd", arguments->rrd,
                      "recording for Rerun: poses, images, status of a session, cloud; FILE.rrd; needs the "
                      "Python package rerun-sdk");
  add_poses_option(*command, arguments->poses);
  command->add_option(
      "--session", arguments->session,
      "session number, counted from 1; 0 = the last; of a disconnected map, only its component is written");
  add_frame_option(*command, arguments->frame);
  add_up_option(*command, arguments->assignments);
  add_set_option(*command, arguments->assignments);
  add_threads_option(*command, arguments->threads);
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { run_export(*arguments); });
}

}  // namespace kinloop
