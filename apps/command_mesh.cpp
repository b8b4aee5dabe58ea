// kinloop mesh: writes the surfaces of a map as a coloured or textured mesh.

#include <algorithm>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "dense/files/mesh_file.hpp"
#include "dense/texture/texture_mesh.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "session/store/command_files.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {
namespace {

struct MeshArguments {
  std::filesystem::path map, poses;
  std::filesystem::path output = "mesh.ply";
  std::string voxel_m, triangles, texture_px;
  bool manifold = false;
  std::string frame = "z-up";
  std::vector<std::string> assignments;
  int threads = hardware_threads();
  bool quiet = false;
};

void require_mesh_name(const std::filesystem::path& output) {
  if (is_mesh_file(output)) return;
  throw UsageError(fmt::format("-o {}: the name must end in {}", output.string(), kMeshExtensions));
}

void require_textured_mesh_name(const std::filesystem::path& output) {
  require_texture_name(output);
  if (is_textured_mesh_file(output)) return;
  throw UsageError(fmt::format("-o {}: {} has no texture; write {}, or leave out --texture", output.string(),
                               output.extension().string(), kTexturedMeshExtensions));
}

std::string summary(const ColoredMesh& mesh, double voxel_m) {
  return fmt::format("{} vertices, {} triangles, voxels of {} m", mesh.points.size(), mesh.triangles.size(),
                     voxel_m);
}

std::string summary(const MeshTexture& texture) {
  const double seen = static_cast<double>(texture.triangles.size() - texture.unseen_triangles);
  const double share = seen / static_cast<double>(std::max<size_t>(texture.triangles.size(), 1));
  std::string text =
      fmt::format(", a texture of {} x {} pixels in {} pieces, which shows {:.1f} % of the triangles",
                  texture.image.cols, texture.image.rows, texture.charts, 100 * share);
  if (texture.scale < 1) text += fmt::format(" at {:.2f} of the resolution of the images", texture.scale);
  return text;
}

void make_mesh(MeshArguments arguments) {
  require_mesh_name(arguments.output);
  if (!arguments.voxel_m.empty()) arguments.assignments.push_back("mesh.voxel_m=" + arguments.voxel_m);
  if (!arguments.triangles.empty()) arguments.assignments.push_back("mesh.triangles=" + arguments.triangles);
  if (arguments.manifold) arguments.assignments.emplace_back("mesh.manifold=true");
  if (!arguments.texture_px.empty()) {
    require_textured_mesh_name(arguments.output);
    arguments.assignments.push_back("mesh.texture_px=" + arguments.texture_px);
  }
  CommandFiles files{.inputs = {map_file_of(arguments.map), arguments.poses}, .outputs = {}};
  files.outputs = outputs_of("-o", mesh_files(arguments.output));
  require_outputs(files);
  const Stopwatch watch;
  OpenMap open = open_map(arguments.map, arguments.assignments, arguments.poses);
  const MeshOptions& options = open.options.mesh;
  if (options.texture_px > 0) require_textured_mesh_name(arguments.output);
  const DenseCamera camera = open.dense_camera();
  const auto views = open.recorder.with_color_gains(open.views(0), camera, arguments.threads);
  require_images(views.size(), arguments.map);
  const auto [mesh, texture] =
      reconstruct_textured_mesh({open.recorder.images(), views, camera}, options, arguments.threads,
                                make_progress_bar(arguments.quiet));
  const FileFrame frame = file_frame(arguments.frame, open.up(0), views);
  if (texture) {
    write_mesh(arguments.output, mesh, *texture, frame);
  } else {
    write_mesh(arguments.output, mesh, frame);
  }
  if (!arguments.quiet)
    fmt::print(message_stream(arguments.output), "{}{}, in {:.1f} s\n", summary(mesh, options.voxel_m),
               texture ? summary(*texture) : "", watch.wall_s());
}

}  // namespace

void add_mesh_command(CLI::App& app) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App* command = app.add_subcommand("mesh", "Create a coloured or textured mesh of a map");
  add_map_argument(*command, arguments->map);
  command
      ->add_option("-o,--output", arguments->output,
                   "FILE.ply, FILE.obj, FILE.glb (glTF), FILE.usda, FILE.usdz or FILE.stl")
      ->capture_default_str();
  add_poses_option(*command, arguments->poses);
  command->add_option("--voxel", arguments->voxel_m, "edge of a voxel, metres (mesh.voxel_m)");
  command->add_option("--triangles", arguments->triangles,
                      "simplify to at most so many triangles (mesh.triangles)");
  command->add_flag("--manifold", arguments->manifold, "separate surfaces that touch (mesh.manifold)");
  command->add_option(
      "--texture", arguments->texture_px,
      "colour the mesh with a texture of at most so many pixels in width and height, made from "
      "the sharpest images: .glb, .obj, .usda, .usdz (mesh.texture_px)");
  add_frame_option(*command, arguments->frame);
  add_up_option(*command, arguments->assignments);
  add_set_option(*command, arguments->assignments);
  add_threads_option(*command, arguments->threads);
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { make_mesh(*arguments); });
}

}  // namespace kinloop
