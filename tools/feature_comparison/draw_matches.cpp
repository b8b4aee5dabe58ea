#include "tools/feature_comparison/draw_matches.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

/// Pads at the bottom with black to at least `rows`.
cv::Mat with_height(const cv::Mat& gray, int rows) {
  cv::Mat padded;
  cv::copyMakeBorder(gray, padded, 0, std::max(0, rows - gray.rows), 0, 0, cv::BORDER_CONSTANT);
  return padded;
}

}  // namespace

cv::Mat draw_matches(const cv::Mat& gray_a, const Features& a, const cv::Mat& gray_b, const Features& b,
                     const std::vector<DescriptorMatch>& matches) {
  require(gray_a.type() == CV_8UC1 && gray_b.type() == CV_8UC1, "draw_matches: expected two grey images");
  constexpr int kCircleRadius = 3;
  cv::Mat side_by_side, picture;
  cv::hconcat(with_height(gray_a, gray_b.rows), with_height(gray_b, gray_a.rows), side_by_side);
  cv::cvtColor(side_by_side, picture, cv::COLOR_GRAY2BGR);
  Random random(1);
  for (const DescriptorMatch& match : matches) {
    const Eigen::Vector2f from = a.raw_pixels[match.a], to = b.raw_pixels[match.b];
    const cv::Point start(cvRound(from.x()), cvRound(from.y()));
    const cv::Point end(gray_a.cols + cvRound(to.x()), cvRound(to.y()));
    const double hue = random.uniform(0, 1);  // saturated colours, well apart
    const cv::Scalar color(255 * std::abs(1 - 2 * hue), 255 * (1 - std::abs(1 - 2 * hue)),
                           255 * random.uniform(0, 1));
    cv::line(picture, start, end, color, 1, cv::LINE_AA);
    cv::circle(picture, start, kCircleRadius, color, 1, cv::LINE_AA);
    cv::circle(picture, end, kCircleRadius, color, 1, cv::LINE_AA);
  }
  return picture;
}

cv::Mat add_caption(const cv::Mat& picture, const std::vector<std::string>& lines) {
  constexpr int kLinePx = 24, kMarginPx = 8;
  constexpr double kLetters = 0.55;
  const int height = kLinePx * static_cast<int>(lines.size()) + kMarginPx;
  cv::Mat captioned;
  cv::copyMakeBorder(picture, captioned, 0, height, 0, 0, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  int baseline = picture.rows - kMarginPx / 2;
  for (const std::string& line : lines) {
    baseline += kLinePx;
    cv::putText(captioned, line, {kMarginPx, baseline}, cv::FONT_HERSHEY_SIMPLEX, kLetters, {0, 0, 0}, 1,
                cv::LINE_AA);
  }
  return captioned;
}

}  // namespace kinloop
