#include "apps/live_stills.hpp"

#include <memory>

#include <fmt/format.h>

#include "apps/interrupt.hpp"
#include "apps/open_source.hpp"
#include "apps/show_run.hpp"
#include "apps/still_screen.hpp"
#include "kinloop/base/log.hpp"

namespace kinloop {
namespace {

SourceRequest request_of(const LiveStills& live, StillKind kind) {
  constexpr int kFullWidth = 1920;  // of a Kinect 2
  SourceRequest request;
  request.sequence = live.source;
  request.kinect.width = kFullWidth;
  if (kind == StillKind::kPairs) request.kinect2_frames = Kinect2Frames::kSeparate;
  return request;
}

}  // namespace

void add_live_options(CLI::App& command, LiveStills& live) {
  command.add_option(
      "--live", live.source,
      "first take stills into DIR, a new folder, with this camera: kinect1, kinect2, or what else\n"
      "kinloop run takes");
  command.add_option("--stills", live.wanted, "how many, at least, with --live")->capture_default_str();
  add_viewer_option(command, live.viewer);
}

void take_live_stills(const LiveStills& live, const std::filesystem::path& folder, const Board& board,
                      StillKind kind) {
  StillCapture capture(folder, board, kind, live.wanted);
  const auto source = open_source(request_of(live, kind));
  std::unique_ptr<StillScreen> screen;
  if (!live.viewer.empty()) {
    screen = std::make_unique<StillScreen>(parse_listen_address(live.viewer), live.source);
    log::info("watch at {}", screen->url());
  }
  catch_interrupts();
  std::string told;
  while (!capture.finished() && !interrupted()) {
    const auto frame = source->next();
    if (!frame) break;
    const StillNews news = capture.take(*frame);
    if (screen) screen->show(frame->color, news);
    if (news.hint != told) {
      fmt::print("{}\n", news.hint);
      std::fflush(stdout);
    }
    told = news.hint;
  }
  fmt::print("{} stills in {}\n", capture.kept(), folder.string());
}

}  // namespace kinloop
