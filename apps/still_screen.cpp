#include "apps/still_screen.hpp"

#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace kinloop {
namespace {

Bytes small_jpeg(const cv::Mat& color) {
  constexpr int kWidth = 640;
  const double scale = std::min(1.0, static_cast<double>(kWidth) / color.cols);
  cv::Mat small;
  cv::resize(color, small, {}, scale, scale, cv::INTER_AREA);
  Bytes bytes;
  cv::imencode(".jpg", small, bytes);
  return bytes;
}

/// The board's corners; green once the still is kept.
Bytes corners_of(const StillNews& news) {
  std::vector<ShownFeature> corners;
  if (news.view) {
    const Eigen::Vector2d size(news.view->width, news.view->height);
    for (const Eigen::Vector2d& pixel : news.view->pixels)
      corners.push_back({pixel.cwiseQuotient(size).cast<float>(), news.kept});
  }
  return encode_features(corners);
}

}  // namespace

StillScreen::StillScreen(const ListenAddress& listen, std::string source)
    : source_(std::move(source)),
      service_(
          listen, [this](Scene& scene, size_t browsers) { update(scene, browsers); }, [](Command) {}) {}

void StillScreen::show(const cv::Mat& color, const StillNews& news) {
  const std::lock_guard lock(mutex_);
  next_ = {color, news};
}

void StillScreen::update(Scene& scene, size_t browsers) {
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
  const std::string hint = picture ? picture->news.hint : "waiting for the camera";
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
  scene.put(PartKind::kFeatures, 0, corners_of(picture->news));
}

}  // namespace kinloop
