#include "apps/show_run.hpp"

#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/interrupt.hpp"
#include "apps/map_store.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/output/ply.hpp"

namespace kinloop {
namespace {

/// Long enough for a browser on the same machine to get what is left.
constexpr std::chrono::seconds kFarewell{1};

void ask_for_leave(LiveViewer& viewer, const std::function<void()>& save_now) {
  while (viewer.control().next_turn(interrupted) == RunControl::Turn::kSave) {
    viewer.tell("mapping", "saving the map");
    save_now();
    viewer.tell("mapping", "the map is saved");
  }
}

}  // namespace

void add_viewer_option(CLI::App& command, std::string& listen) {
  command.add_flag(
      "--viewer{8080}", listen,
      "show the run in a browser: --viewer=PORT (0 = any that is free), or --viewer=ADDRESS:PORT for\n"
      "other machines, with a token in the URL that is printed");
}

std::unique_ptr<ShownRun> show_run(const std::string& listen, const FrameSource& source,
                                   const ViewerOptions& options, Slam& slam,
                                   const std::function<void()>& save_now) {
  if (listen.empty()) return nullptr;
  const SourceInfo& info = source.info();
  auto shown = std::make_unique<ShownRun>(
      parse_listen_address(listen),
      RunBasics{info.name, info.frames, source.camera(), info.ground_truth, options});
  slam.listen(shown->viewer.listener());
  shown->leave = [&viewer = shown->viewer, save_now] { ask_for_leave(viewer, save_now); };
  log::info("watch at {}", shown->viewer.url());
  return shown;
}

void save_map(const RunFolder& folder, const Slam& slam, DenseRecorder& recorder, const std::string& frame,
              int threads) {
  write_tum_trajectory(folder.trajectory(), slam.trajectory());
  const ColoredCloud cloud = recorder.fuse(slam, threads, {});
  write_ply(folder.map(), cloud, file_frame(frame, recorder.up(slam), recorder.views(slam)));
}

void stay_open(LiveViewer& viewer) {
  viewer.tell("finished");
  if (isatty(STDIN_FILENO) == 0 || isatty(STDERR_FILENO) == 0) {
    if (viewer.browsers() > 0) std::this_thread::sleep_for(kFarewell);
    return;
  }
  if (!interrupted()) log::info("still to be seen at {}; Ctrl-C ends", viewer.url());
  wait_for_interrupt();
}

}  // namespace kinloop
