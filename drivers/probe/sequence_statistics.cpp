#include "drivers/probe/sequence_statistics.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/quantile.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {

std::optional<RateStatistics> rate_statistics(std::span<const int64_t> stamps_ns) {
  constexpr double kGap = 1.5;
  if (stamps_ns.size() < 3) return std::nullopt;
  std::vector<double> intervals_s;
  for (size_t i = 1; i < stamps_ns.size(); ++i)
    intervals_s.push_back(to_seconds(stamps_ns[i] - stamps_ns[i - 1]));
  RateStatistics rate;
  rate.duration_s = to_seconds(stamps_ns.back() - stamps_ns.front());
  rate.median_interval_s = median(intervals_s);
  std::vector<double> deviations_s;
  for (const double interval_s : intervals_s) {
    if (interval_s <= kGap * rate.median_interval_s) {
      deviations_s.push_back(std::abs(interval_s - rate.median_interval_s));
      continue;
    }
    ++rate.gaps;
    rate.longest_gap_s = std::max(rate.longest_gap_s, interval_s);
  }
  rate.jitter_s = spread_of(deviations_s).high;
  return rate;
}

Spread spread_of(const std::vector<double>& values) {
  constexpr double kTail = 0.05;
  return {quantile(values, kTail), median(values), quantile(values, 1 - kTail)};
}

DepthStatistics depth_statistics(std::span<const Frame> frames) {
  constexpr int kStep_px = 8;  // a sample is enough
  std::vector<double> depths_m;
  size_t pixels = 0;
  for (const Frame& frame : frames) {
    for (int y = 0; y < frame.depth_m.rows; y += kStep_px) {
      const auto* row = frame.depth_m.ptr<float>(y);
      for (int x = 0; x < frame.depth_m.cols; x += kStep_px) {
        ++pixels;
        if (row[x] > 0) depths_m.push_back(static_cast<double>(row[x]));
      }
    }
  }
  const double share = pixels == 0 ? 0 : static_cast<double>(depths_m.size()) / static_cast<double>(pixels);
  return {spread_of(depths_m), share};
}

std::optional<double> plausible_depth_scale(double median_m, double depth_scale) {
  constexpr double kNearest_m = 0.3, kFarthest_m = 20, kRoomNear_m = 0.6, kRoomFar_m = 5;
  const bool possible = median_m >= kNearest_m && median_m <= kFarthest_m;
  if (possible || !(median_m > 0)) return std::nullopt;
  for (const double scale : {1000.0, 5000.0, 10000.0, 4000.0, 256.0, 1.0}) {
    const double with_scale_m = median_m * depth_scale / scale;
    if (scale != depth_scale && with_scale_m >= kRoomNear_m && with_scale_m <= kRoomFar_m) return scale;
  }
  return std::nullopt;
}

}  // namespace kinloop
