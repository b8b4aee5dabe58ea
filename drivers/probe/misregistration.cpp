// Estimates how far depth is shifted against colour. The borders of near objects in depth are also edges in
// the colour image, if both are registered; shifted by the right vector, they meet the strongest gradients.

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "drivers/probe/sequence_statistics.hpp"
#include "kinloop/sensor/surfaces/depth_borders.hpp"

namespace kinloop {
namespace {

constexpr int kWidth_px = 640, kMaxShift_px = 20, kSide = 2 * kMaxShift_px + 1;

/// Pixels of near objects at their borders, away from the edge of the image by the largest shift.
std::vector<cv::Point> borders_of(const cv::Mat& depth_m) {
  constexpr int kMaxShadow_px = 12;
  std::vector<cv::Point> borders;
  const auto add = [&](int x, int y) {
    const bool inside = x >= kMaxShift_px && y >= kMaxShift_px && x < depth_m.cols - kMaxShift_px &&
                        y < depth_m.rows - kMaxShift_px;
    if (inside) borders.emplace_back(x, y);
  };
  for (int y = 0; y < depth_m.rows; ++y) {
    find_depth_borders(
        depth_m.cols, kMaxShadow_px, [&](int x) { return depth_m.at<float>(y, x); },
        [&](int x) { add(x, y); });
  }
  for (int x = 0; x < depth_m.cols; ++x) {
    find_depth_borders(
        depth_m.rows, kMaxShadow_px, [&](int y) { return depth_m.at<float>(y, x); },
        [&](int y) { add(x, y); });
  }
  return borders;
}

/// The gradient's magnitude, limited so that a few strong edges do not decide.
cv::Mat gradient_of(const cv::Mat& color) {
  constexpr double kStrong = 100;
  cv::Mat gray, dx, dy, magnitude;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::GaussianBlur(gray, gray, {}, 1.0);
  cv::Sobel(gray, dx, CV_32F, 1, 0);
  cv::Sobel(gray, dy, CV_32F, 0, 1);
  cv::magnitude(dx, dy, magnitude);
  return cv::min(magnitude, kStrong);
}

/// Adds the mean gradient at the shifted borders to `scores`, for each shift.
void add_scores(const std::vector<cv::Point>& borders, const cv::Mat& gradient, cv::Mat& scores) {
  for (int dy = -kMaxShift_px; dy <= kMaxShift_px; ++dy) {
    for (int dx = -kMaxShift_px; dx <= kMaxShift_px; ++dx) {
      double sum = 0;
      for (const cv::Point& p : borders) sum += static_cast<double>(gradient.at<float>(p.y + dy, p.x + dx));
      scores.at<double>(dy + kMaxShift_px, dx + kMaxShift_px) += sum / static_cast<double>(borders.size());
    }
  }
}

/// The vertex of the parabola through three values around a maximum, from -0.5 to 0.5.
double vertex_of(double before, double at, double after) {
  const double curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0;
}

}  // namespace

std::optional<Misregistration> misregistration(std::span<const Frame> frames) {
  constexpr size_t kFewestBorders = 200, kMostBorders = 4000;
  constexpr double kClear = 1.15;
  cv::Mat scores = cv::Mat::zeros(kSide, kSide, CV_64FC1);
  double scale = 1;
  bool any = false;
  for (const Frame& frame : frames) {
    cv::Mat color = frame.color.bgr(), depth_m = frame.depth_m;
    scale = std::max(1.0, static_cast<double>(depth_m.cols) / kWidth_px);
    const cv::Size size(cvRound(depth_m.cols / scale), cvRound(depth_m.rows / scale));
    if (scale > 1) {
      cv::resize(color, color, size, 0, 0, cv::INTER_AREA);
      cv::resize(depth_m, depth_m, size, 0, 0, cv::INTER_NEAREST);
    }
    std::vector<cv::Point> borders = borders_of(depth_m);
    if (borders.size() < kFewestBorders) continue;
    const size_t step = borders.size() / kMostBorders + 1;
    std::vector<cv::Point> sample;
    for (size_t i = 0; i < borders.size(); i += step) sample.push_back(borders[i]);
    add_scores(sample, gradient_of(color), scores);
    any = true;
  }
  cv::Point best;
  double highest = 0;
  cv::minMaxLoc(scores, nullptr, &highest, nullptr, &best);
  const double contrast = any ? highest / cv::mean(scores)[0] : 0;
  const bool at_limit = best.x == 0 || best.y == 0 || best.x == kSide - 1 || best.y == kSide - 1;
  if (contrast < kClear || at_limit) return std::nullopt;
  const auto at = [&](int x, int y) { return scores.at<double>(y, x); };
  const double x = best.x + vertex_of(at(best.x - 1, best.y), highest, at(best.x + 1, best.y)) - kMaxShift_px;
  const double y = best.y + vertex_of(at(best.x, best.y - 1), highest, at(best.x, best.y + 1)) - kMaxShift_px;
  return Misregistration{Eigen::Vector2d(x, y) * scale, contrast};
}

}  // namespace kinloop
