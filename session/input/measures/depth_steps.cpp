#include "session/input/measures/depth_steps.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

using Levels = std::vector<DepthLevels::Level>;

constexpr size_t kValues = 1U << 16;

/// The distances between successive levels, m.
std::vector<double> gaps_m(std::span<const DepthLevels::Level> levels) {
  std::vector<double> gaps;
  for (size_t i = 1; i < levels.size(); ++i) gaps.push_back(levels[i].depth_m - levels[i - 1].depth_m);
  return gaps;
}

constexpr double kSmallest_per_m = 1e-4, kBinFactor = 1.05, kNearest_m = 0.125;
constexpr int kPeakBins = 4;  // 20 % to either side

/// The centre of a bin.
double bin_per_m(int bin) {
  return kSmallest_per_m * std::pow(kBinFactor, bin + 0.5);
}

}  // namespace

DepthLevels::DepthLevels(double depth_scale)
    : units_per_m_(std::max(depth_scale, 1000.0)), counts_(kValues) {}  // metres are read to the millimetre

void DepthLevels::add(const cv::Mat& depth_m) {
  constexpr int kColumns = 40;
  const int step = std::max(1, depth_m.cols / kColumns);
  for (int y = step / 2; y < depth_m.rows; y += step) {
    const auto* row = depth_m.ptr<float>(y);
    for (int x = step / 2; x < depth_m.cols; x += step) {
      const double units = static_cast<double>(row[x]) * units_per_m_ + 0.5;
      if (!(row[x] > 0) || !(units < static_cast<double>(kValues))) continue;
      ++counts_[static_cast<size_t>(units)];
      ++pixels_;
    }
  }
}

Levels DepthLevels::levels() const {
  constexpr double kStray = 2e-4;
  const double fewest = std::max(2.0, kStray * static_cast<double>(pixels_));
  Levels found;
  for (size_t i = 0; i < kValues; ++i) {
    if (counts_[i] >= fewest)
      found.push_back({static_cast<double>(i) / units_per_m_,
                       static_cast<double>(counts_[i]) / static_cast<double>(pixels_)});
  }
  return found;
}

std::optional<double> uniform_step_m(const Levels& levels) {
  constexpr size_t kFewest = 4;
  constexpr double kTolerance = 0.08, kMostLevels = 0.9;
  constexpr int kMaxMissing = 3;
  if (levels.size() < kFewest) return std::nullopt;
  const std::vector<double> gaps = gaps_m(levels);
  const double step_m = median(gaps);
  const auto fits = std::count_if(gaps.begin(), gaps.end(), [&](double gap_m) {
    const double steps = gap_m / step_m, whole = std::round(steps);
    return whole >= 1 && whole <= kMaxMissing && std::abs(steps - whole) < kTolerance;
  });
  return static_cast<double>(fits) > kMostLevels * static_cast<double>(gaps.size()) ? std::optional(step_m)
                                                                                    : std::nullopt;
}

void DisparitySteps::add(const cv::Mat& depth_m) {
  constexpr int kColumns = 40;
  const int step = std::max(4, depth_m.cols / kColumns);  // so that there are two pixels before the first
  for (int y = step / 2; y < depth_m.rows; y += step) {
    const auto* row = depth_m.ptr<float>(y);
    for (int x = step / 2; x < depth_m.cols; x += step) {
      // A step has a level beside it. Without noise, the inverse depth of a plane rises evenly, too.
      const bool level = row[x - 2] == row[x - 1] || (x + 1 < depth_m.cols && row[x] == row[x + 1]);
      if (level && row[x - 1] > 0 && row[x] > 0) add_pair(row[x - 1], row[x]);
    }
  }
}

void DisparitySteps::add_pair(float a_m, float b_m) {
  // Below, rounding to units moves a difference by too much of itself.
  constexpr double kMinUnits = 4;
  const double near_m = static_cast<double>(std::min(a_m, b_m)),
               far_m = static_cast<double>(std::max(a_m, b_m));
  const double difference_m = far_m - near_m;
  if (difference_m < 0.5 * unit_m_) return;
  const double distance = 2 * std::log2(near_m / kNearest_m);
  if (!(distance >= 0 && distance < kDistances)) return;
  Histogram& histogram = histograms_[static_cast<size_t>(distance)];
  ++histogram.differing;
  if (difference_m < (kMinUnits - 0.5) * unit_m_) return;
  const double bin = std::log(difference_m / (near_m * far_m) / kSmallest_per_m) / std::log(kBinFactor);
  if (bin >= 0 && bin < kBins) ++histogram.counts[static_cast<size_t>(bin)];
}

/// Of differences that are spread like noise, less than a fifth lies within 20 % of one value.
std::optional<double> DisparitySteps::Histogram::peak_per_m() const {
  constexpr size_t kFewest = 60;
  constexpr double kMinShare = 0.4;
  if (differing < kFewest) return std::nullopt;
  int best = 0;
  uint32_t most = 0;
  for (int bin = kPeakBins; bin + kPeakBins < kBins; ++bin) {
    uint32_t sum = 0;
    for (int i = bin - kPeakBins; i <= bin + kPeakBins; ++i) sum += counts[static_cast<size_t>(i)];
    if (sum > most) best = bin, most = sum;
  }
  if (most < kMinShare * static_cast<double>(differing)) return std::nullopt;
  double moment = 0;
  for (int i = best - kPeakBins; i <= best + kPeakBins; ++i)
    moment += bin_per_m(i) * counts[static_cast<size_t>(i)];
  return moment / most;
}

std::optional<double> DisparitySteps::per_m() const {
  constexpr double kSame = 1.15, kMostAgree = 0.65;
  // Steps of the same size everywhere, over z^2, may agree from one distance to the next, but differ by a
  // factor of two from there to the one after.
  constexpr size_t kApart = 2;
  std::vector<size_t> distances;  // those that have a peak
  std::vector<double> peaks_per_m;
  for (size_t i = 0; i < kDistances; ++i) {
    const auto peak = histograms_[i].peak_per_m();
    if (peak) distances.push_back(i), peaks_per_m.push_back(*peak);
  }
  const double middle = median(peaks_per_m);
  size_t agree = 0, first = kDistances, last = 0;
  for (size_t i = 0; i < distances.size(); ++i) {
    if (std::max(peaks_per_m[i] / middle, middle / peaks_per_m[i]) > kSame) continue;
    ++agree, first = std::min(first, distances[i]), last = distances[i];
  }
  const bool most = static_cast<double>(agree) > kMostAgree * static_cast<double>(peaks_per_m.size());
  return most && last >= first + kApart ? std::optional(middle) : std::nullopt;
}

}  // namespace kinloop
