// kinloop view: shows the results of a run in a browser.

#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "apps/run/run_viewer.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/interrupt.hpp"
#include "apps/shared/progress_bar.hpp"
#include "kinloop/back_end/executor.hpp"
#include "kinloop/core/log.hpp"
#include "viewer/keyframe_images.hpp"
#include "viewer/saved_map.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {
namespace {

struct ViewArguments {
  std::filesystem::path path;
  std::string listen;
};

/// Fills the scene: first the run, then the images, which take longer to read.
class SavedRunFeed {
 public:
  explicit SavedRunFeed(const std::filesystem::path& path)
      : run_(read_shown(path, make_progress_bar(false))),
        executor_(make_executor({.mode = ExecutorMode::kLive})) {
    executor_->submit({}, {.kind = "keyframe images", .work = [this, path]() -> Completion {
                             return [this, images = keyframe_images_of(path, run_.keyframes)] {
                               images_ = images;
                             };
                           }});
  }

  void update(Scene& scene) {
    if (!std::exchange(shown_, true)) return show_saved_run(scene, run_);
    for (const FinishedJob& job : executor_->collect({})) job.complete();
    for (KeyframeImage& image : std::exchange(images_, {}))
      scene.put(PartKind::kKeyframeImage, image.keyframe, std::move(image.jpeg));
  }

 private:
  SavedRun run_;
  bool shown_ = false;
  std::vector<KeyframeImage> images_;   // read, not shown yet
  std::unique_ptr<Executor> executor_;  // last member: its job uses the run
};

void view(const ViewArguments& arguments) {
  const ListenAddress listen = parse_listen_address(arguments.listen);
  SavedRunFeed feed(arguments.path);
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
      ->add_option("--port", arguments->listen,
                   "PORT (0 = any free port), or ADDRESS:PORT to allow other machines")
      ->default_str("8080");
  add_viewer_option(*command, arguments->listen)->group("");  // same syntax as for kinloop run
  command->callback([arguments] { view(*arguments); });
}

}  // namespace kinloop
