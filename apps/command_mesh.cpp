// kinloop mesh: writes the surfaces of a map as a coloured mesh.

#include <fmt/format.h>

#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "apps/shared/progress_bar.hpp"
#include "apps/shared/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/dense/mesh/reconstruct_mesh.hpp"
#include "kinloop/io/mesh_file.hpp"
#include "session/map_store.hpp"

namespace kinloop {
namespace {

struct MeshArguments {
  std::filesystem::path map, poses;
  std::filesystem::path output = "mesh.ply";
  std::string voxel_m, triangles;
  bool manifold = false;
  std::string frame = "z-up";
  std::vector<std::string> assignments;
  int threads = hardware_threads();
  bool quiet = false;
};

void make_mesh(MeshArguments arguments) {
  if (!is_mesh_file(arguments.output)) {
    throw UsageError(
        fmt::format("-o {}: the name must end in {}", arguments.output.string(), kMeshExtensions));
  }
  if (!arguments.voxel_m.empty()) arguments.assignments.push_back("mesh.voxel_m=" + arguments.voxel_m);
  if (!arguments.triangles.empty()) arguments.assignments.push_back("mesh.triangles=" + arguments.triangles);
  if (arguments.manifold) arguments.assignments.emplace_back("mesh.manifold=true");
  require_writable_file(arguments.output);
  const Stopwatch watch;
  OpenMap open = open_map(arguments.map, arguments.assignments, arguments.poses);
  const DenseCamera camera = open.dense_camera();
  const auto views = open.recorder.with_color_gains(open.views(0), camera, arguments.threads);
  require_images(views.size(), arguments.map);
  const auto mesh = reconstruct_mesh(open.recorder.images(), views, camera, open.options.mesh,
                                     arguments.threads, make_progress_bar(arguments.quiet));
  write_mesh(arguments.output, mesh, file_frame(arguments.frame, open.up(0), views));
  if (!arguments.quiet) {
    fmt::print(message_stream(arguments.output), "{} vertices, {} triangles, voxels of {} m, in {:.1f} s\n",
               mesh.points.size(), mesh.triangles.size(), open.options.mesh.voxel_m, watch.wall_s());
  }
}

}  // namespace

void add_mesh_command(CLI::App& app) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App* command = app.add_subcommand("mesh", "Create a coloured mesh of a map");
  add_map_argument(*command, arguments->map);
  command->add_option("-o,--output", arguments->output, "FILE.ply, FILE.obj, FILE.glb (glTF) or FILE.stl")
      ->capture_default_str();
  add_poses_option(*command, arguments->poses);
  command->add_option("--voxel", arguments->voxel_m, "edge of a voxel, metres (mesh.voxel_m)");
  command->add_option("--triangles", arguments->triangles,
                      "simplify to at most so many triangles (mesh.triangles)");
  command->add_flag("--manifold", arguments->manifold, "separate surfaces that touch (mesh.manifold)");
  add_frame_option(*command, arguments->frame);
  add_up_option(*command, arguments->assignments);
  add_set_option(*command, arguments->assignments);
  add_threads_option(*command, arguments->threads);
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { make_mesh(*arguments); });
}

}  // namespace kinloop
