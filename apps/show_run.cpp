#include "apps/show_run.hpp"

#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/interrupt.hpp"
#include "apps/map_store.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/eval/report.hpp"
#include "kinloop/output/ply.hpp"
#include "viewer/saved_run.hpp"

namespace kinloop {
namespace {

/// Long enough for a browser on the same machine to get what is left.
constexpr std::chrono::seconds kFarewell{1};

/// PORT, HOST:PORT or [IPv6]:PORT, and not a file of that name, or sim:room:7.
bool looks_like_address(const std::string& word) {
  constexpr const char* kDigits = "0123456789";
  const size_t port = word.find_last_not_of(kDigits);
  if (port == std::string::npos) return !word.empty();
  if (word[port] != ':' || port + 1 == word.size()) return false;
  const std::string host = word.substr(0, port);
  const bool bracketed = host.starts_with('[') && host.ends_with(']');
  return bracketed || (!host.empty() && host != "sim" && host.find_first_of(":/") == std::string::npos);
}

void ask_for_leave(LiveViewer& viewer, const std::function<void()>& save_now) {
  while (viewer.control().next_turn(interrupted) == RunControl::Turn::kSave) {
    viewer.tell("mapping", "saving the map");
    save_now();
    viewer.tell("mapping", "the map is saved");
  }
}

}  // namespace

CLI::Option* add_viewer_option(CLI::App& command, std::string& listen) {
  return command
      .add_flag("--viewer{8080}", listen,
                "show the run in a browser; --viewer PORT is another port (0 = any that is free), --viewer\n"
                "ADDRESS:PORT is for other machines, with a token in the URL that is printed")
      ->option_text("[[ADDRESS:]PORT]");
}

std::vector<std::string> with_viewer_address(std::vector<std::string> words) {
  for (size_t i = 0; i + 1 < words.size() && words[i] != "--"; ++i) {
    if (words[i] != "--viewer" || !looks_like_address(words[i + 1])) continue;
    words[i] += "=" + words[i + 1];
    words.erase(words.begin() + static_cast<long>(i) + 1);
  }
  return words;
}

std::unique_ptr<ShownRun> show_run(const std::string& listen, const FrameSource& source,
                                   const ViewerOptions& options, Slam& slam,
                                   const std::function<void()>& save_now) {
  if (listen.empty()) return nullptr;
  const SourceInfo& info = source.info();
  auto shown = std::make_unique<ShownRun>(
      parse_listen_address(listen),
      RunBasics{name_of_input(info.name), info.frames, source.camera(), info.ground_truth, options});
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
  const bool somebody_there = isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0;
  if (!somebody_there || interrupted()) {
    if (viewer.browsers() > 0) std::this_thread::sleep_for(kFarewell);
    return;
  }
  log::info("the run has ended; still to be seen at {} until Ctrl-C", viewer.url());
  wait_for_interrupt();
}

}  // namespace kinloop
