#include "session/input/measures/depth_levels.hpp"

#include <algorithm>
#include <cmath>
#include <span>

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

}  // namespace kinloop
