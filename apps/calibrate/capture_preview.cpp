#include "apps/calibrate/capture_preview.hpp"

#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "kinloop/sensor/images/jpeg_codec.hpp"

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
          listen, [this](Scene& scene, size_t browsers) { update(scene, browsers); }, [](Command) {}) {}

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

}  // namespace kinloop
