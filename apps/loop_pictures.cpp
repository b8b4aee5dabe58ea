#include "apps/loop_pictures.hpp"

#include <algorithm>

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

/// Key points of `a` and `b` that look alike and, by the loop, are the same places.
std::vector<LookAlike> agreeing_matches(const LoopEdge& loop, const Features& a, const Features& b,
                                        const PinholeCamera& camera) {
  constexpr double kMaxErrorPx = 8;
  std::vector<LookAlike> agreeing;
  for (const LookAlike& match :
       screen_look_alikes(match_descriptors(a, b), b.descriptors.type() == CV_8UC1)) {
    if (!(b.depths_m[match.b] > 0)) continue;
    const Eigen::Vector3d p_a = loop.T_a_b * camera.unproject(b.pixels[match.b].cast<double>(),
                                                              static_cast<double>(b.depths_m[match.b]));
    if (p_a.z() <= 0) continue;
    const double error_px = (camera.project(p_a) - a.pixels[match.a].cast<double>()).norm();
    if (error_px < kMaxErrorPx) agreeing.push_back(match);
  }
  return agreeing;
}

/// Empty where the images were not kept.
cv::Mat picture_of(const LoopEdge& loop, const Map& map, const PinholeCamera& camera,
                   const DenseRecorder& recorder) {
  const Keyframe &a = map.keyframe(loop.a), &b = map.keyframe(loop.b);
  const auto images_a = recorder.images_of(a.frame), images_b = recorder.images_of(b.frame);
  if (!images_a || !images_b) return {};
  cv::Mat gray_a, gray_b, small;
  cv::cvtColor(images_a->color, gray_a, cv::COLOR_BGR2GRAY);
  cv::cvtColor(images_b->color, gray_b, cv::COLOR_BGR2GRAY);
  const cv::Mat full = draw_matches(gray_a, *a.features, gray_b, *b.features,
                                    agreeing_matches(loop, *a.features, *b.features, camera));
  const double scale = std::min(1.0, static_cast<double>(kWidthPx) / full.cols);
  cv::resize(full, small, {}, scale, scale, cv::INTER_AREA);
  return small;
}

/// Those of an earlier run; what else lies there is somebody's.
void remove_pictures(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".jpg") std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace

void write_loop_pictures(const RunFolder& folder, const Map& map, const PinholeCamera& camera,
                         const DenseRecorder& recorder) {
  remove_pictures(folder.loop_pictures());
  const auto& loops = map.loop_edges();
  const size_t count = std::min(kMostPictures, loops.size());
  if (count == 0) return;
  make_folder(folder.loop_pictures());
  for (size_t i = 0; i < count; ++i) {
    const LoopEdge& loop = loops[i * loops.size() / count];
    const cv::Mat picture = picture_of(loop, map, camera, recorder);
    if (picture.empty()) continue;
    std::vector<uint8_t> jpeg;
    cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    // The name tells the report what it shows.
    const auto name = fmt::format("{}_{}.jpg", format_stamp(map.keyframe(loop.a).stamp_ns),
                                  format_stamp(map.keyframe(loop.b).stamp_ns));
    write_file(folder.loop_pictures() / name, {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
  }
}

}  // namespace kinloop
