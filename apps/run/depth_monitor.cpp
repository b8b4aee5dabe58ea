#include "apps/run/depth_monitor.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr double kMin_m = 1e-4, kBinsPerE = 20;

/// Below this share of depth within the map's range, the map is almost empty.
constexpr double kMinInRangeRatio = 0.05;

/// Typical depth indoors: from a desk in front of the camera to the far wall of a hall.
constexpr double kRoomNear_m = 0.6, kRoomFar_m = 4, kRoomMiddle_m = 1.6;

size_t bin_of(double depth_m, size_t bins) {
  const double bin = kBinsPerE * std::log(std::max(depth_m, kMin_m) / kMin_m);
  return std::min(static_cast<size_t>(bin), bins - 1);
}

}  // namespace

void DepthMonitor::on_frame(const TrackedFrame& tracked) {
  const Frame& frame = *tracked.frame;
  constexpr int kStep_px = 16;  // a sample is enough
  for (int row = 0; row < frame.depth_m.rows; row += kStep_px) {
    for (int col = 0; col < frame.depth_m.cols; col += kStep_px) {
      const auto depth_m = static_cast<double>(frame.depth_m.at<float>(row, col));
      if (!(depth_m > 0)) continue;
      ++known_;
      ++counts_[bin_of(depth_m, kBins)];
      near_ += depth_m < limits_.min_depth_m ? 1 : 0;
      far_ += depth_m > limits_.max_depth_m ? 1 : 0;
    }
  }
  constexpr size_t kFirst = 10, kEnough = 30;  // a third of a second, and a second
  ++frames_;
  if (frames_ == kFirst && !problem().empty()) log::warn("in the first {} frames {}", kFirst, problem());
  if (frames_ == kEnough && impossible())
    throw InputError(fmt::format("depth is outside the range of any RGB-D camera: {}", problem()));
}

double DepthMonitor::share_in_range() const {
  return known_ == 0 ? 0 : static_cast<double>(known_ - near_ - far_) / static_cast<double>(known_);
}

double DepthMonitor::quantile_m(double q) const {
  const double wanted = q * static_cast<double>(known_);
  size_t below = 0, bin = 0;
  while (bin + 1 < kBins && static_cast<double>(below + counts_[bin]) <= wanted) below += counts_[bin++];
  return kMin_m * std::exp((static_cast<double>(bin) + 0.5) / kBinsPerE);
}

/// A scene may be far, but the noise of triangulated depth, 1.4e-3 z^2, is half a metre at 20 m; and no depth
/// camera works at 0.1 m, where it can neither focus nor match.
bool DepthMonitor::impossible() const {
  constexpr double kNone_m = 0.1, kAll_m = 20, kTail = 0.1;
  return known_ > 0 && (quantile_m(kTail) > kAll_m || quantile_m(1 - kTail) < kNone_m);
}

bool DepthMonitor::unusable() const {
  return frames_ > 0 && (share_in_range() < kMinInRangeRatio || median_m() < limits_.min_depth_m);
}

std::optional<double> DepthMonitor::plausible_scale() const {
  if (known_ == 0 || (median_m() >= limits_.min_depth_m && median_m() <= limits_.max_depth_m))
    return std::nullopt;
  if (median_m() >= kRoomNear_m && median_m() <= kRoomFar_m)
    return std::nullopt;  // the scale is plausible as it is
  const auto median_with = [&](double scale) { return median_m() * scale_ / scale; };
  const auto fits = [&](double scale) {
    return scale != scale_ && median_with(scale) >= kRoomNear_m && median_with(scale) <= kRoomFar_m;
  };
  const auto off = [&](double scale) { return std::abs(std::log(median_with(scale) / kRoomMiddle_m)); };
  // Millimetres and the TUM format cover nearly all recordings; then 0.1 mm (RealSense close range), 1/4 mm,
  // ICL-NUIM's variants, metres.
  std::optional<double> best;
  for (const double scale : {1000.0, 5000.0}) {
    if (fits(scale) && (!best || off(scale) < off(*best))) best = scale;
  }
  for (const double scale : {10000.0, 4000.0, 256.0, 1.0}) {
    if (!best && fits(scale)) best = scale;
  }
  return best;
}

std::string DepthMonitor::problem() const {
  if (frames_ == 0) return {};
  if (known_ == 0) return "all pixels of the depth images are empty";
  const bool few = share_in_range() < kMinInRangeRatio;
  const bool far = far_ > near_;
  const double median = median_m();
  if (!few && median >= limits_.min_depth_m && median <= limits_.max_depth_m) return {};
  const auto likely = plausible_scale();
  const double share = static_cast<double>(far ? far_ : near_) / static_cast<double>(known_);
  std::string text = fmt::format(
      "{:.0f} % of the depth lies {} {} m (median {:.2g} m), which the map ignores; ", 100 * share,
      far ? "beyond" : "nearer than", far ? limits_.max_depth_m : limits_.min_depth_m, median);
  text += likely ? fmt::format(
                       "with depth_scale: {} instead of {} the median would be {:.1f} m: set that in "
                       "camera.yaml, or",
                       *likely, scale_, median * scale_ / *likely)
                 : fmt::format("check depth_scale ({} units per metre) in camera.yaml, or", scale_);
  return text + fmt::format(", if the scene is that {}, --set dense.{}", far ? "far" : "near",
                            far ? "max_depth_m=..." : "min_depth_m=...");
}

}  // namespace kinloop
