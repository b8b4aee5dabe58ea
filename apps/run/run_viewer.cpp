#include "apps/run/run_viewer.hpp"

#include <chrono>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/shared/terminal/interrupt.hpp"
#include "kinloop/core/log.hpp"
#include "viewer/report/report.hpp"
#include "viewer/saved/saved_run.hpp"

namespace kinloop {
namespace {

/// How long browsers may take to receive the rest.
constexpr std::chrono::seconds kShutdownGrace{5};

/// Matches PORT, HOST:PORT or [IPv6]:PORT, but neither a file of that name nor sim:room:7.
bool looks_like_address(const std::string& word) {
  constexpr const char* kDigits = "0123456789";
  const size_t port = word.find_last_not_of(kDigits);
  if (port == std::string::npos) return !word.empty();
  if (word[port] != ':' || port + 1 == word.size()) return false;
  const std::string host = word.substr(0, port);
  const bool bracketed = host.starts_with('[') && host.ends_with(']');
  return bracketed || (!host.empty() && host != "sim" && host.find_first_of(":/") == std::string::npos);
}

void handle_pause_and_save(LiveViewer& viewer, const std::function<void()>& save_now) {
  while (viewer.control().next_action(interrupted) == RunControl::Action::kSaveMap) {
    viewer.set_stage("mapping", "saving map");
    save_now();
    viewer.set_stage("mapping", "map saved");
  }
}

std::vector<std::string> hints_of(const RecordingAdvisor& advisor) {
  std::vector<std::string> texts;
  for (const RecordingHint hint : advisor.hints()) texts.emplace_back(text_of(hint));
  return texts;
}

}  // namespace

void show_warnings(LiveViewer& viewer, const InputMonitor& input) {
  std::vector<std::string> texts;
  for (const InputWarning& warning : input.warnings()) texts.push_back(text_of(warning));
  viewer.set_warnings(std::move(texts));
}

CLI::Option* add_viewer_option(CLI::App& command, std::string& listen) {
  return command
      .add_flag("--viewer{8080}", listen,
                "show the run in a browser; PORT selects the port (0 = any free port),\n"
                "ADDRESS:PORT allows other machines, which need the token in the printed URL")
      ->option_text("[[ADDRESS:]PORT]");
}

std::vector<std::string> join_viewer_address(std::vector<std::string> words) {
  for (size_t i = 0; i + 1 < words.size() && words[i] != "--"; ++i) {
    if (words[i] != "--viewer" || !looks_like_address(words[i + 1])) continue;
    words[i] += "=" + words[i + 1];
    words.erase(words.begin() + static_cast<long>(i) + 1);
  }
  return words;
}

std::unique_ptr<RunViewer> start_run_viewer(const std::string& listen, const ViewerOptions& options,
                                            Session& session, const std::function<void()>& save_now) {
  if (listen.empty()) return nullptr;
  const FrameSource& source = session.source();
  const SourceInfo& info = source.info();
  RunInfo shown_info{input_name(info.name), info.frames, source.camera(), info.ground_truth, options};
  if (const auto up = session.recorder().given_up()) shown_info.up = up->direction;
  auto shown = std::make_unique<RunViewer>(parse_listen_address(listen), std::move(shown_info));
  session.add_listener(shown->viewer.listener());
  shown->wait_until_resumed = [&viewer = shown->viewer, &input = session.input(),
                               &advisor = session.advisor(), &slam = session.slam(), save_now,
                               told = size_t{0}]() mutable {
    if (input.warnings().size() != told) show_warnings(viewer, input);
    told = input.warnings().size();
    viewer.set_hints(hints_of(advisor));
    viewer.set_sensor(slam.sensor_estimate());
    handle_pause_and_save(viewer, save_now);
  };
  log::info("viewer at {}", shown->viewer.url());
  return shown;
}

void serve_until_interrupted(LiveViewer& viewer) {
  viewer.set_stage("finished");
  const bool somebody_there = isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0;
  if (!somebody_there || interrupted()) {
    if (!viewer.wait_until_sent(kShutdownGrace)) log::warn("a browser has not received the end of the run");
    return;
  }
  log::info("run finished; viewer stays at {} until Ctrl-C", viewer.url());
  wait_for_interrupt();
}

}  // namespace kinloop
