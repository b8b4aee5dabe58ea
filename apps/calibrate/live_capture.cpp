#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "apps/calibrate/calibrate_steps.hpp"
#include "apps/run/run_viewer.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "session/source/open_frame_source.hpp"

namespace kinloop {

namespace {

WireBytes small_jpeg(const cv::Mat& color) {
  constexpr int kWidth = 640, kQuality = 90;
  const double scale = std::min(1.0, static_cast<double>(kWidth) / color.cols);
  cv::Mat small;
  cv::resize(color, small, {}, scale, scale, cv::INTER_AREA);
  return encode_jpeg(small, kQuality);
}

/// The board's corners; green if the image was kept.
WireBytes corners_of(const CaptureFeedback& feedback) {
  std::vector<ShownFeature> corners;
  if (feedback.view) {
    const Eigen::Vector2d size(feedback.view->width, feedback.view->height);
    for (const Eigen::Vector2d& pixel : feedback.view->pixels)
      corners.push_back({pixel.cwiseQuotient(size).cast<float>(), feedback.kept});
  }
  return encode_features(corners);
}

}  // namespace

CapturePreview::CapturePreview(const ListenAddress& listen, std::string source)
    : source_(std::move(source)),
      service_(
          listen, [this](Scene& scene, size_t browsers) { update(scene, browsers); }, [](const Command&) {}) {
}

void CapturePreview::show(const cv::Mat& color, const CaptureFeedback& feedback) {
  const std::lock_guard lock(mutex_);
  next_ = {color, feedback};
}

void CapturePreview::update(Scene& scene, size_t browsers) {
  std::optional<Picture> picture;
  {
    const std::lock_guard lock(mutex_);
    picture = std::exchange(next_, std::nullopt);
  }
  if (seen_ == 0) {
    constexpr double kNoFrustum = 0;
    scene.put(PartKind::kHello, 0,
              encode_json({{"run", scene.run()},
                           {"input", source_},
                           {"live", true},
                           {"frustum", {kNoFrustum, kNoFrustum}}}));
  }
  if (!picture && seen_ > 0) return;
  const std::string hint = picture ? picture->feedback.hint : "waiting for the camera";
  scene.put(PartKind::kStatus, 0,
            encode_json({{"stage", "calibrating"},
                         {"message", hint},
                         {"paused", false},
                         {"frame", ++seen_},
                         {"frames", 0},
                         {"keyframes", 0},
                         {"landmarks", 0},
                         {"loops", 0},
                         {"points", 0},
                         {"up", {0, -1, 0}}}));
  if (!picture || browsers == 0) return;
  scene.put(PartKind::kColorImage, 0, small_jpeg(picture->color));
  scene.put(PartKind::kFeatures, 0, corners_of(picture->feedback));
}

namespace {

SourceRequest request_of(const LiveCaptureOptions& live, StillKind kind) {
  constexpr int kFullWidth = 1920;  // of a Kinect 2
  SourceRequest request;
  request.sequence = live.source;
  request.kinect.width = kFullWidth;
  if (kind == StillKind::kPairs) request.kinect.frames = Kinect2Frames::kSeparate;
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
  print_text(fmt::format("{} stills in {}\n", capture.kept(), folder.string()));
}

}  // namespace kinloop
