// kinloop view: shows the results of a run in a browser.

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/map/compare_maps.hpp"
#include "apps/map/withdraw_from_file.hpp"
#include "apps/run/run_viewer.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/view/shown_feed.hpp"
#include "kinloop/core/log.hpp"
#include "viewer/saved/comparison.hpp"
#include "viewer/saved/keyframe_images.hpp"
#include "viewer/saved/saved_map.hpp"
#include "viewer/saved/sent_shapes.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {
namespace {

constexpr std::chrono::milliseconds kBetweenCommands{50};

struct ViewArguments {
  std::filesystem::path path, compared;  ///< the second: empty unless two maps are compared
  std::string listen;
};

Shown shown_run(const std::filesystem::path& path, std::string greeting = "");

/// Writes the map without a loop beside it, and shows that.
Shown shown_without(const std::filesystem::path& map, const std::string& loop) {
  const auto output = free_withdrawn_name(map);
  withdraw_from_file({map, output, {loop}}, interruptible(make_progress_bar(false)));
  log::info("{}: without the loop {}", output.string(), loop);
  return shown_run(output, fmt::format("The map without the loop is {}.", output.filename().string()));
}

Shown shown_run(const std::filesystem::path& path, std::string greeting) {
  const auto run = std::make_shared<const SavedRun>(read_shown(path, make_progress_bar(false)));
  const auto pieces = std::make_shared<const std::vector<CloudPiece>>(split_into_pieces(run->cloud));
  Shown shown{.show = [run, pieces](Scene& scene) { show_first(scene, *run, *pieces); },
              .rest = {},
              .tell = [run](Scene& scene, const Notice& notice) { show_notice(scene, *run, notice); },
              .greeting = std::move(greeting)};
  for (size_t i = 0; i < batch_count(*pieces); ++i)
    shown.rest.emplace_back([run, pieces, i] { return encode_batch(*run, *pieces, i); });
  shown.rest.emplace_back(
      [run, path] { return encode_keyframe_images(keyframe_images_of(path, run->keyframes)); });
  if (!run->map_file.empty())
    shown.withdraw = [map = run->map_file](const std::string& loop) { return shown_without(map, loop); };
  return shown;
}

Shown shown_comparison(const MergeRequest& maps) {
  install_interrupt_handler();  // joining large maps takes long
  const auto compared = std::make_shared<const Comparison>(
      comparison_of(compare_maps(maps, interruptible(make_progress_bar(false))), maps));
  const auto read_images = [compared, maps] {
    const ComparedVisit &before = compared->before, &after = compared->after;
    auto images = keyframe_images_of(maps.a, before.keyframes);
    for (KeyframeImage& image : keyframe_images_of(maps.b, after.keyframes)) {
      image.keyframe += static_cast<uint32_t>(before.keyframes.size());
      images.push_back(std::move(image));
    }
    return encode_keyframe_images(std::move(images));
  };
  return {.show = [compared](Scene& scene) { show_comparison(scene, *compared); }, .rest = {read_images}};
}

void view(const ViewArguments& arguments) {
  const ListenAddress listen = parse_listen_address(arguments.listen);
  ShownFeed feed(arguments.compared.empty()
                     ? shown_run(arguments.path)
                     : shown_comparison({.a = arguments.path, .b = arguments.compared}));
  const ViewerService service(
      listen, [&](Scene& scene, size_t) { feed.update(scene); },
      [&](const Command& command) { feed.take(command); });
  install_interrupt_handler();
  log::info("viewer at {}; press Ctrl-C to stop", service.url());
  while (!interrupted()) {
    feed.work();
    std::this_thread::sleep_for(kBetweenCommands);
  }
}

}  // namespace

void add_view_command(CLI::App& app) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command =
      app.add_subcommand("view", "Show a run's folder, a map file, a cloud or a mesh in a browser");
  command
      ->add_option("DIR|FILE", arguments->path,
                   "the output folder of kinloop run -o DIR, a map file (.kinmap), a cloud (.ply, .pcd) "
                   "or\na mesh (.ply, .glb), also from other programs")
      ->required();
  command
      ->add_option("--compare", arguments->compared,
                   "overlay another map of this place (the folder of a run, or a .kinmap file): what it\n"
                   "added, moved and no longer has, as kinloop map diff finds it")
      ->option_text("DIR|FILE");
  command
      ->add_option("--port", arguments->listen,
                   "PORT (0 = any free port), or ADDRESS:PORT to allow other machines")
      ->default_str("8080");
  add_viewer_option(*command, arguments->listen)->group("");  // same syntax as for kinloop run
  command->footer(
      "Examples:\n"
      "  kinloop view out\n"
      "  kinloop view monday --compare tuesday");
  command->callback([arguments] { view(*arguments); });
}

}  // namespace kinloop
