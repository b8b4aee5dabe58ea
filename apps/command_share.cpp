// kinloop share: the results of a run as one page to pass on.

#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "session/store/command_files.hpp"
#include "viewer/saved/saved_map.hpp"
#include "viewer/saved/shared_page.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

struct ShareArguments {
  fs::path path;
  fs::path output = "share.html";
  bool mesh = false, no_images = false, quiet = false;
  std::optional<int> points;
  double max_size_mb = 20;
};

/// "1000 of 2000 points, 300 triangles, 4 images": what the page holds, but no cloud where only a mesh was
/// read.
std::string contents_text(const SharedPage& page, size_t all_points) {
  std::string text;
  if (all_points > 0 || page.triangles == 0)
    text += fmt::format("{} of {} points, ", page.points, all_points);
  if (page.triangles > 0) text += fmt::format("{} triangles, ", page.triangles);
  return text + fmt::format("{} images", page.images);
}

void share(const ShareArguments& arguments) {
  CommandFiles files{.inputs = {arguments.path / "mesh.ply", arguments.path / "mesh.glb"},
                     .outputs = {{"-o", arguments.output}}};
  add_input(files, arguments.path);
  require_outputs(files);
  install_interrupt_handler();
  SavedRun run = read_shown(arguments.path, interruptible(make_progress_bar(arguments.quiet)));
  select_contents(run, arguments.mesh, arguments.points.has_value(), arguments.path);
  const size_t all_points = run.cloud.size();
  std::vector<KeyframeImage> images;
  if (!arguments.no_images) images = keyframe_images_of(arguments.path, run.keyframes, kSharedImages);
  SharedPageLimits limits{.bytes = page_bytes("--max-size", arguments.max_size_mb)};
  if (arguments.points) limits.points = static_cast<size_t>(*arguments.points);
  const SharedPage page = make_shared_page(std::move(run), std::move(images), limits);
  throw_if_interrupted();
  write_file(arguments.output, page.html);
  if (arguments.quiet) return;
  print_text(
      fmt::format("{}: {:.1f} MB, {}\n", arguments.output.string(),
                  static_cast<double>(page.html.size()) / kBytesPerMb, contents_text(page, all_points)),
      message_stream(arguments.output));
}

}  // namespace

void add_share_command(CLI::App& app) {
  constexpr int kMostPoints = 100'000'000;
  auto arguments = std::make_shared<ShareArguments>();
  CLI::App* command =
      app.add_subcommand("share", "Write a run's map as one HTML file that opens without kinloop");
  command
      ->add_option("DIR|FILE", arguments->path,
                   "the output folder of kinloop run -o DIR, a map file (.kinmap), a cloud (.ply, .pcd) "
                   "or\na mesh (.ply, .glb)")
      ->required();
  command->add_option("-o,--output", arguments->output, "write the page here")->capture_default_str();
  command->add_flag("--mesh", arguments->mesh,
                    "the mesh in the folder (mesh.ply, mesh.glb) in place of the cloud; with --points, both");
  command
      ->add_option("--points", arguments->points, "keep at most this many points (default: as many as fit)")
      ->check(whole_number(0, kMostPoints));
  command->add_option("--max-size", arguments->max_size_mb, "largest size of the page, MB")
      ->check(number(kSmallestPageMb, kLargestPageMb))
      ->capture_default_str();
  command->add_flag("--no-images", arguments->no_images, "leave out the images of keyframes");
  add_quiet_option(*command, arguments->quiet);
  command->footer("Example: kinloop share out -o room.html");
  command->callback([arguments] { share(*arguments); });
}

}  // namespace kinloop
