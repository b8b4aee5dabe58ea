// kinloop view: shows the results of a run in a browser.

#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/map/compare_maps.hpp"
#include "apps/run/run_viewer.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/interrupt.hpp"
#include "apps/shared/progress_bar.hpp"
#include "kinloop/back_end/executor.hpp"
#include "kinloop/core/log.hpp"
#include "viewer/comparison.hpp"
#include "viewer/keyframe_images.hpp"
#include "viewer/saved_map.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {
namespace {

struct ViewArguments {
  std::filesystem::path path, compared;  ///< the second: empty unless two maps are compared
  std::string listen;
};

/// What a page shows: first the map, then the images, which take longer to read.
struct Shown {
  std::function<void(Scene&)> show;
  std::function<std::vector<KeyframeImage>()> read_images;
};

/// Fills the scene.
class ShownFeed {
 public:
  explicit ShownFeed(const Shown& shown)
      : show_(shown.show), executor_(make_executor({.mode = ExecutorMode::kLive})) {
    executor_->submit({},
                      {.kind = "keyframe images", .work = [this, read = shown.read_images]() -> Completion {
                         return [this, images = read()] { images_ = images; };
                       }});
  }

  void update(Scene& scene) {
    if (const auto show = std::exchange(show_, {})) return show(scene);
    for (const FinishedJob& job : executor_->collect({})) job.complete();
    for (KeyframeImage& image : std::exchange(images_, {}))
      scene.put(PartKind::kKeyframeImage, image.keyframe, std::move(image.jpeg));
  }

 private:
  std::function<void(Scene&)> show_;    // until it is done
  std::vector<KeyframeImage> images_;   // read, not shown yet
  std::unique_ptr<Executor> executor_;  // last member: its job uses the others
};

Shown shown_run(const std::filesystem::path& path) {
  const auto run = std::make_shared<const SavedRun>(read_shown(path, make_progress_bar(false)));
  return {[run](Scene& scene) { show_saved_run(scene, *run); },
          [run, path] { return keyframe_images_of(path, run->keyframes); }};
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
    return images;
  };
  return {[compared](Scene& scene) { show_comparison(scene, *compared); }, read_images};
}

void view(const ViewArguments& arguments) {
  const ListenAddress listen = parse_listen_address(arguments.listen);
  ShownFeed feed(arguments.compared.empty()
                     ? shown_run(arguments.path)
                     : shown_comparison({.a = arguments.path, .b = arguments.compared}));
  const ViewerService service(
      listen, [&](Scene& scene, size_t) { feed.update(scene); }, [](Command) {});
  install_interrupt_handler();
  log::info("viewer at {}; press Ctrl-C to stop", service.url());
  wait_for_interrupt();
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
