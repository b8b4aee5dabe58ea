#include "apps/calibrate/live_capture.hpp"

#include <memory>

#include <fmt/format.h>

#include "apps/calibrate/capture_preview.hpp"
#include "apps/run/run_viewer.hpp"
#include "apps/shared/interrupt.hpp"
#include "kinloop/core/log.hpp"
#include "session/open_frame_source.hpp"

namespace kinloop {
namespace {

SourceRequest request_of(const LiveCaptureOptions& live, StillKind kind) {
  constexpr int kFullWidth = 1920;  // of a Kinect 2
  SourceRequest request;
  request.sequence = live.source;
  request.kinect.width = kFullWidth;
  if (kind == StillKind::kPairs) request.kinect2_frames = Kinect2Frames::kSeparate;
  request.stop = interrupted;
  return request;
}

}  // namespace

void add_live_options(CLI::App& command, LiveCaptureOptions& live) {
  command.add_option(
      "--live", live.source,
      "first capture images into DIR, a new folder, from this source: kinect1, kinect2, openni2, "
      "or any other\nsource of kinloop run");
  command.add_option("--stills", live.wanted, "minimum number of images for --live")->capture_default_str();
  add_viewer_option(command, live.viewer);
}

void capture_live_stills(const LiveCaptureOptions& live, const std::filesystem::path& folder,
                         const Board& board, StillKind kind) {
  StillCapture capture(folder, board, kind, live.wanted);
  const auto source = open_frame_source(request_of(live, kind));
  std::unique_ptr<CapturePreview> screen;
  if (!live.viewer.empty()) {
    screen = std::make_unique<CapturePreview>(parse_listen_address(live.viewer), live.source);
    log::info("viewer at {}", screen->url());
  }
  install_interrupt_handler();
  std::string printed_hint;
  while (!capture.finished() && !interrupted()) {
    const auto frame = source->next();
    if (!frame) break;
    const CaptureFeedback feedback = capture.process(*frame);
    if (screen) screen->show(frame->color.bgr(), feedback);
    if (feedback.hint != printed_hint) {
      fmt::print("{}\n", feedback.hint);
      std::fflush(stdout);
    }
    printed_hint = feedback.hint;
  }
  fmt::print("{} stills in {}\n", capture.kept(), folder.string());
}

}  // namespace kinloop
