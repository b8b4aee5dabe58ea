#include "apps/run/summary/run_warnings.hpp"

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

void warn_of_unlikely_up(const UpEstimate& up) {
  constexpr double kUnlikely = 0.2;  // of clean rooms at least 0.48, of a clip turned by 90 degrees 0
  if (up.source != UpSource::kCamera || up.confidence > kUnlikely) return;
  log::warn(
      "the images are taken as upright, but the surfaces do not look so (confidence {:.2f}); if the camera "
      "was "
      "turned, use --up X,Y,Z, e.g. --up 1,0,0 if right in the images is up",
      up.confidence);
}

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

namespace {

/// Explains why a map has no points although its depth is in range.
std::string explain_empty_map(const RunOutcome& o) {
  if (o.slam.map().keyframes().empty()) return "no frame was located";
  const DenseOptions& dense = o.plan.options.dense;
  return fmt::format(
      "no surface was observed by {} images (dense.min_observations) at less than {} degrees "
      "(dense.max_incidence_deg) without free-space violation (dense.carve)",
      dense.min_observations, dense.limits.max_incidence_deg);
}

/// Tells of skipped frames; returns whether they are at most half of all.
bool check_skipped(const FrameSource& source, size_t processed) {
  const auto skipped = source.skipped();
  if (skipped.empty()) return true;
  log::warn("{} skipped; the first: {}: {}",
            skipped.size() == 1 ? "1 frame was" : fmt::format("{} frames were", skipped.size()),
            skipped.front().name, skipped.front().reason);
  if (skipped.size() <= processed) return true;
  log::error("{}: over half of the frames could not be used ({} of {}); the results cover the others",
             source.info().name, skipped.size(), skipped.size() + processed);
  return false;
}

std::string describe_tracking_loss(const Map& map) {
  if (map.keyframes().empty()) return "no frame had enough keypoints with depth to initialise the map";
  return "tracking was lost and relocalisation failed";
}

}  // namespace

bool check_result(const RunOutcome& o, const Trajectory& trajectory, const DepthMonitor& depth) {
  const bool enough = check_skipped(*o.plan.source, o.slam.session_log().size());
  const std::string problem = depth.problem();
  const bool empty = o.map_points && *o.map_points == 0;  // otherwise no cloud was requested
  const bool useless = !problem.empty() && (depth.unusable() || empty);
  if (useless) {
    log::error("the map is unusable: {}", problem);
  } else if (!problem.empty()) {
    log::warn("{}", problem);
  } else if (empty && !o.slam.session_log().empty()) {
    log::warn("the map has no points: {}", explain_empty_map(o));
  }
  const Trajectory& truth = o.plan.source->info().ground_truth;
  if (!o.evaluation && !truth.empty() && !trajectory.empty())
    log::warn("trajectory error not computed: {}", evaluation_failure(trajectory, truth));
  const bool hopeless = std::any_of(o.warnings.begin(), o.warnings.end(),
                                    [](const InputWarning& warning) { return warning.hopeless; });
  return enough && !useless && !hopeless;
}

ExitCode exit_code(const Slam& slam, int signal, const std::filesystem::path& details) {
  if (signal != 0) return exit_code_of_signal(signal);
  const auto log = slam.session_log();
  if (!log.empty() && is_tracked_in(slam.component(), log.back(), slam.map())) return ExitCode::kDone;
  log::error("{}; see {}", describe_tracking_loss(slam.map()), details.string());
  return ExitCode::kTrackingLost;
}

}  // namespace kinloop
