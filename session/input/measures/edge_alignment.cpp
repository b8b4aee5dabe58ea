#include "session/input/measures/edge_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/quantile.hpp"
#include "kinloop/sensor/surfaces/depth_borders.hpp"
#include "session/input/measures/small_images.hpp"

namespace kinloop {
namespace {

constexpr int kSide_px = 160;

cv::Size small_size(const cv::Size& size) {
  const double scale = std::min(1.0, static_cast<double>(kSide_px) / std::max(size.width, size.height));
  return {std::max(1, cvRound(scale * size.width)), std::max(1, cvRound(scale * size.height))};
}

/// The coarsest octave that is not smaller than `size`; making an image smaller costs more than all else.
cv::Mat coarse_gray(const Frame& frame, const cv::Size& size) {
  cv::Mat gray = gray_of(frame);
  for (const cv::Mat& octave : frame.octaves) {
    if (octave.cols >= size.width && octave.rows >= size.height) gray = octave;
  }
  return gray;
}

/// The gradient's magnitude relative to that of its surroundings, so that neither texture nor light decides
/// where edges are.
cv::Mat edge_contrast(const cv::Mat& gray, const cv::Size& size) {
  constexpr double kBlur_px = 0.7, kSobelSum = 8, kNoise = 1, kStrongest = 2;
  constexpr int kSurroundings_px = 13;
  cv::Mat small, dx, dy, gradient, mean;
  cv::resize(gray, small, size, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::GaussianBlur(small, small, {}, kBlur_px);
  cv::Sobel(small, dx, CV_32F, 1, 0, 3, 1 / kSobelSum);
  cv::Sobel(small, dy, CV_32F, 0, 1, 3, 1 / kSobelSum);
  cv::magnitude(dx, dy, gradient);
  cv::blur(gradient, mean, {kSurroundings_px, kSurroundings_px});
  cv::Mat contrast = (gradient - mean) / (mean + kNoise);
  return cv::min(contrast, kStrongest);
}

/// Marks the borders in a line of pixels. `step` is the distance of neighbours in memory.
void mark_borders(const float* depths_m, uchar* borders, int length, int step) {
  constexpr int kMaxShadow_px = 3;
  find_depth_borders(
      length, kMaxShadow_px, [&](int i) { return depths_m[i * step]; },
      [&](int i) { borders[i * step] = 1; });
}

std::vector<Eigen::Vector2f> borders_of(const cv::Mat& depth_m) {
  constexpr size_t kMost = 256;
  cv::Mat marked = cv::Mat::zeros(depth_m.size(), CV_8UC1);
  for (int y = 0; y < depth_m.rows; ++y)
    mark_borders(depth_m.ptr<float>(y), marked.ptr<uchar>(y), depth_m.cols, 1);
  for (int x = 0; x < depth_m.cols; ++x)
    mark_borders(depth_m.ptr<float>(0) + x, marked.ptr<uchar>(0) + x, depth_m.rows, depth_m.cols);
  std::vector<cv::Point> all;
  cv::findNonZero(marked, all);
  const Eigen::Vector2f middle(0.5F * static_cast<float>(depth_m.cols - 1),
                               0.5F * static_cast<float>(depth_m.rows - 1));
  std::vector<Eigen::Vector2f> borders;
  const size_t count = std::min(all.size(), kMost);
  for (size_t i = 0; i < count; ++i) {
    const cv::Point& at = all[i * all.size() / count];
    borders.push_back(Eigen::Vector2f(static_cast<float>(at.x), static_cast<float>(at.y)) - middle);
  }
  return borders;
}

using Eigen::Vector2d;

constexpr int kRange_px = EdgeSample::kMargin_px, kShifts = 2 * kRange_px + 1;

/// Depth borders on colour edges, for every shift of one scale.
struct ScaleScores {
  Vector2d scale;
  cv::Mat scores;  ///< 32FC1 by shift, comparable between scales
  size_t borders = 0;
};

/// Adds the edges around each mapped border: entry (y, x) is the edge at that shift.
void add_scores(const EdgeSample& sample, ScaleScores& sum) {
  const Eigen::Vector2f scale = sum.scale.cast<float>();
  const Eigen::Vector2f middle(0.5F * static_cast<float>(sample.size.width - 1),
                               0.5F * static_cast<float>(sample.size.height - 1));
  for (const Eigen::Vector2f& border : sample.borders) {
    const Eigen::Vector2f mapped = scale.cwiseProduct(border) + middle;
    const cv::Point at(cvRound(mapped.x()), cvRound(mapped.y()));
    if (!cv::Rect({}, sample.size).contains(at)) continue;
    ++sum.borders;
    for (int dy = 0; dy < kShifts; ++dy) {  // the margin shifts (0, 0) to the middle
      const float* edges = sample.edges.ptr<float>(at.y + dy) + at.x;
      float* to = sum.scores.ptr<float>(dy);
      for (int dx = 0; dx < kShifts; ++dx) to[dx] += edges[dx];
    }
  }
}

ScaleScores scores_of(std::span<const EdgeSample> samples, const Vector2d& scale) {
  ScaleScores sum{scale, cv::Mat::zeros(kShifts, kShifts, CV_32FC1), 0};
  for (const EdgeSample& sample : samples) add_scores(sample, sum);
  // The sum over borders that are nowhere in particular grows with the root of their number.
  if (sum.borders > 0) sum.scores /= std::sqrt(static_cast<double>(sum.borders));
  return sum;
}

/// Scales by 8 % from 0.5 to 2; depth that was stretched from another format is wider or higher: from 16:9 to
/// 4:3 and back, or from 512 x 424 to 16:9 and back.
std::vector<Vector2d> tried_scales(AlignmentSearch search) {
  std::vector<Vector2d> scales = {{1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
  if (search == AlignmentSearch::kMirrored) return scales;
  constexpr double kStep = 1.08, kWide = 4.0 / 3, kKinect2 = 1.472;
  constexpr int kSteps = 9;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (const double aspect : {1.0, kWide, 1 / kWide, kKinect2, 1 / kKinect2}) {
      if (i == 0 && aspect == 1) continue;
      scales.emplace_back(std::pow(kStep, i) * std::sqrt(aspect), std::pow(kStep, i) / std::sqrt(aspect));
    }
  }
  return scales;
}

/// The highest score, smoothed, within `range_px` of no shift.
struct Peak {
  double score = 0;
  cv::Point shift_px;
};

Peak peak_of(const ScaleScores& scores, int range_px) {
  constexpr double kSmooth_px = 0.8;
  cv::Mat smooth;
  cv::GaussianBlur(scores.scores, smooth, {5, 5}, kSmooth_px);
  const cv::Point first(kRange_px - range_px, kRange_px - range_px);
  Peak peak;
  cv::minMaxLoc(smooth(cv::Rect(first, cv::Size(2 * range_px + 1, 2 * range_px + 1))), nullptr, &peak.score,
                nullptr, &peak.shift_px);
  peak.shift_px += first - cv::Point(kRange_px, kRange_px);
  return peak;
}

double deviation_of(const ScaleScores& scores) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(scores.scores, mean, deviation);
  return deviation[0];
}

/// Whether two scales are told apart by edges.
bool differ(const Vector2d& a, const Vector2d& b) {
  constexpr double kSame = 0.13;
  if (a.x() * b.x() < 0 || a.y() * b.y() < 0) return true;
  return std::abs(std::log(a.x() / b.x())) > kSame || std::abs(std::log(a.y() / b.y())) > kSame;
}

/// Improves a scale to 1 %.
ScaleScores refined(std::span<const EdgeSample> samples, ScaleScores best) {
  for (const double step : {0.03, 0.01}) {
    const Vector2d center = best.scale;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const Vector2d factor(1 + x * step, 1 + y * step);
        ScaleScores other = scores_of(samples, center.cwiseProduct(factor));
        if (peak_of(other, kRange_px).score > peak_of(best, kRange_px).score) best = std::move(other);
      }
    }
  }
  return best;
}

}  // namespace

EdgeImages edge_images_of(const Frame& frame) {
  const cv::Size size = small_size(frame.depth_m.size());
  return {coarse_gray(frame, size), sampled_depth(frame.depth_m, size)};
}

EdgeSample make_edge_sample(const EdgeImages& images) {
  constexpr int kMargin = EdgeSample::kMargin_px;
  EdgeSample sample;
  sample.size = images.depth_m.size();
  cv::copyMakeBorder(edge_contrast(images.gray, sample.size), sample.edges, kMargin, kMargin, kMargin,
                     kMargin, cv::BORDER_CONSTANT, 0);
  sample.borders = borders_of(images.depth_m);
  return sample;
}

EdgeSample make_edge_sample(const Frame& frame) {
  return make_edge_sample(edge_images_of(frame));
}

std::optional<EdgeAlignment> align_edges(std::span<const EdgeSample> samples, AlignmentSearch search) {
  constexpr size_t kFewestBorders = 300;
  constexpr double kMinShare = 0.2;  // of the borders, within the image
  // Depth that is 15 ms late is shifted by up to 2 % while the camera turns at 1 rad/s.
  constexpr int kMotion_px = 3;
  size_t total = 0;
  for (const EdgeSample& sample : samples) total += sample.borders.size();
  if (total < kFewestBorders) return std::nullopt;

  std::vector<ScaleScores> all;
  std::vector<double> deviations;
  for (const Vector2d& scale : tried_scales(search)) {
    ScaleScores scores = scores_of(samples, scale);
    if (static_cast<double>(scores.borders) < kMinShare * static_cast<double>(total)) continue;
    deviations.push_back(deviation_of(scores));
    all.push_back(std::move(scores));
  }
  const double deviation = std::max(median(deviations), 1e-9);
  const auto score = [&](const ScaleScores& one) { return peak_of(one, kRange_px).score; };
  const auto by_score = [&](const auto& a, const auto& b) { return score(a) < score(b); };
  ScaleScores best = *std::max_element(all.begin(), all.end(), by_score);
  if (search == AlignmentSearch::kAll && best.scale != Vector2d(1, 1))
    best = refined(samples, std::move(best));

  const Peak peak = peak_of(best, kRange_px);
  const double side_px = std::max(samples.front().size.width, samples.front().size.height);
  EdgeAlignment found;
  found.best = {best.scale, Vector2d(peak.shift_px.x, peak.shift_px.y) / side_px};
  found.best_score = peak.score / deviation;
  found.registered_score = peak_of(all.front(), kMotion_px).score / deviation;
  for (const ScaleScores& other : all) {
    if (differ(other.scale, best.scale) && differ(other.scale, {1, 1}))
      found.other_score = std::max(found.other_score, score(other) / deviation);
  }
  return found;
}

}  // namespace kinloop
