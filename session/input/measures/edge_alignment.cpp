#include "session/input/measures/edge_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

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
