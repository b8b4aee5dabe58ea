#include "apps/loop_pictures.hpp"

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/base/text_file.hpp"
#include "kinloop/base/time.hpp"
#include "kinloop/compare/match_picture.hpp"

namespace kinloop {
namespace {

constexpr size_t kMostPictures = 12;
constexpr int kWidthPx = 960;
constexpr int kJpegQuality = 80;

/// Key points of the two keyframes that show the same landmark.
std::vector<LookAlike> shared_landmarks(const Keyframe& a, const Keyframe& b) {
  std::unordered_map<LandmarkId, uint32_t> feature_of;
  for (uint32_t i = 0; i < a.landmark_of.size(); ++i) {
    if (a.landmark_of[i].valid()) feature_of.emplace(a.landmark_of[i], i);
  }
  std::vector<LookAlike> shared;
  for (uint32_t i = 0; i < b.landmark_of.size(); ++i) {
    const auto found = b.landmark_of[i].valid() ? feature_of.find(b.landmark_of[i]) : feature_of.end();
    if (found != feature_of.end()) shared.push_back({found->second, i, 0});
  }
  return shared;
}

/// Empty where the images were not kept.
cv::Mat picture_of(const Keyframe& a, const Keyframe& b, const DenseRecorder& recorder) {
  const auto images_a = recorder.images_of(a.frame), images_b = recorder.images_of(b.frame);
  if (!images_a || !images_b) return {};
  cv::Mat gray_a, gray_b, small;
  cv::cvtColor(images_a->color, gray_a, cv::COLOR_BGR2GRAY);
  cv::cvtColor(images_b->color, gray_b, cv::COLOR_BGR2GRAY);
  const cv::Mat full = draw_matches(gray_a, *a.features, gray_b, *b.features, shared_landmarks(a, b));
  const double scale = std::min(1.0, static_cast<double>(kWidthPx) / full.cols);
  cv::resize(full, small, {}, scale, scale, cv::INTER_AREA);
  return small;
}

}  // namespace

void write_loop_pictures(const RunFolder& folder, const Map& map, const DenseRecorder& recorder) {
  std::error_code ignored;
  std::filesystem::remove_all(folder.loop_pictures(), ignored);
  const auto& loops = map.loop_edges();
  const size_t count = std::min(kMostPictures, loops.size());
  if (count == 0) return;
  std::filesystem::create_directory(folder.loop_pictures(), ignored);
  for (size_t i = 0; i < count; ++i) {
    const LoopEdge& loop = loops[i * loops.size() / count];
    const Keyframe &a = map.keyframe(loop.a), &b = map.keyframe(loop.b);
    const cv::Mat picture = picture_of(a, b, recorder);
    if (picture.empty()) continue;
    std::vector<uint8_t> jpeg;
    cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    // The name tells the report what it shows.
    const auto name = fmt::format("{}_{}.jpg", format_stamp(a.stamp_ns), format_stamp(b.stamp_ns));
    write_file(folder.loop_pictures() / name, {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
  }
}

}  // namespace kinloop
