#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "session/input/checks/checks.hpp"
#include "session/input/measures/usual_depth_scale.hpp"

namespace kinloop {
namespace {

using Levels = std::vector<DepthLevels::Level>;

constexpr size_t kFewestPixels = 3000;

InputWarning values_warning(std::string evidence, std::string remedy) {
  return {InputFault::kDepthValues, std::move(evidence), std::move(remedy), false};
}

/// A limit at which depth is clipped has far more pixels than the values beside it.
bool is_clipped_at(const DepthLevels::Level& limit, const DepthLevels::Level& beside) {
  constexpr double kMinShare = 0.04, kOverNeighbor = 5;
  return limit.share > kMinShare && limit.share > kOverNeighbor * beside.share;
}

std::optional<InputWarning> clipped(const Levels& levels) {
  constexpr size_t kFewest = 10;
  if (levels.size() < kFewest) return std::nullopt;
  const bool far = is_clipped_at(levels.back(), levels[levels.size() - 2]);
  if (!far && !is_clipped_at(levels.front(), levels[1])) return std::nullopt;
  const DepthLevels::Level& limit = far ? levels.back() : levels.front();
  return values_warning(
      fmt::format("depth is clipped: {:.0f} % of its pixels are at exactly {:.3f} m and hardly any is {}",
                  100 * limit.share, limit.depth_m, far ? "farther" : "nearer"),
      "record depth without a limit, or set such pixels to 0, which means unknown");
}

/// The raw values of a Kinect 1: disparities of 11 bits, of which those beyond 1100 do not occur, and 2047
/// for unknown. The conversion is that of S. Magnenat in the OpenKinect project.
std::optional<InputWarning> raw_disparity(const Levels& levels, double unit_m) {
  constexpr double kUnknown = 2047, kLargest = 1100, kSmallest = 250, kMinShare = 0.005;
  constexpr size_t kFewest = 10;
  const auto value_of = [&](const DepthLevels::Level& level) { return std::round(level.depth_m / unit_m); };
  if (levels.size() < kFewest || value_of(levels.back()) != kUnknown || levels.back().share < kMinShare)
    return std::nullopt;
  if (value_of(levels[levels.size() - 2]) > kLargest || value_of(levels.front()) < kSmallest)
    return std::nullopt;
  return values_warning(
      fmt::format("depth is the raw disparity of a Kinect 1: values of 11 bits up to {:.0f}, and {:.0f} % of "
                  "2047, which means unknown",
                  value_of(levels[levels.size() - 2]), 100 * levels.back().share),
      "convert each value d to 0.1236 tan(d / 2842.5 + 1.1863) m, and 2047 to 0");
}

/// Whether the sensor is a Kinect 1 or one of its relatives (Xtion, Carmine) as far as is known: named so, or
/// nobody named it and colour has their aspect and view. Published calibrations have 0.81 to 0.85; depth of a
/// RealSense, whose steps are about half as large, comes with 0.5 to 0.75 or 0.95.
bool is_known_as_kinect1(const RgbdCamera& camera) {
  constexpr double kNarrowest = 0.86, kWidest = 0.79;
  if (camera.sensor.origin != SensorOrigin::kAssumed) return true;
  const double share = camera.color.fx / camera.color.width;
  return 3 * camera.color.width == 4 * camera.color.height && share > kWidest && share < kNarrowest;
}

/// Whether registration enlarges depth images: it interpolates then, which leaves smaller steps.
bool is_enlarged(const RgbdCamera& camera) {
  constexpr double kMagnification = 1.1;
  return camera.depth && camera.color.fx > kMagnification * camera.depth->fx;
}

/// `factor` is what depth must be multiplied by.
std::string unit_remedy(const RgbdCamera& camera, double factor, double tolerance) {
  constexpr const char* kUnless = "unless the sensor is another one (sensor: in camera.yaml)";
  if (camera.has_metric_depth)
    return fmt::format("depth seems to be in another unit: multiply it by {:.3g}, {}", factor, kUnless);
  return fmt::format("depth_scale: {} instead of {:g} fits, {}",
                     depth_scale_text(camera.depth_scale / factor, camera.depth_scale, tolerance),
                     camera.depth_scale, kUnless);
}

}  // namespace

std::optional<InputWarning> DepthValuesCheck::values() const {
  constexpr double kConstant = 0.9, kCoarse_m = 0.008;
  if (levels_.pixels() < kFewestPixels) return std::nullopt;
  const Levels levels = levels_.levels();
  const auto by_share = [](const auto& a, const auto& b) { return a.share < b.share; };
  const auto most = std::max_element(levels.begin(), levels.end(), by_share);
  if (most != levels.end() && most->share > kConstant)
    return values_warning(fmt::format("depth is constant: {:.0f} % of its pixels are at exactly {:.3f} m",
                                      100 * most->share, most->depth_m),
                          "check what writes the depth images");
  if (auto found = raw_disparity(levels, levels_.unit_m())) return found;
  if (auto found = clipped(levels)) return found;
  const auto step_m = uniform_step_m(levels);
  if (!step_m || *step_m < kCoarse_m) return std::nullopt;
  return values_warning(fmt::format("depth has only {} values, in steps of {:.3g} m", levels.size(), *step_m),
                        "record depth with 16 bits per pixel, in mm or finer");
}

std::optional<InputWarning> DepthValuesCheck::unit() const {
  // 1 / (8 f b) of a Kinect 1, f = 580 px, b = 75 mm, disparities in steps of 1/8 px. Three recordings of
  // Kinects have 0.0028 to 0.0029, simulated ones 0.0031.
  constexpr double kKinect1_per_m = 1 / (8 * 580 * 0.075);
  constexpr double kKnown = 1.5, kAssumed = 2.5, kUsual = 1.3;
  if (camera_.sensor.kind != DepthSensorKind::kStructuredLight || is_enlarged(camera_)) return std::nullopt;
  const auto step_per_m = steps_.per_m();
  if (!step_per_m) return std::nullopt;
  const double factor = *step_per_m / kKinect1_per_m;  // steps k z^2 of depth that is s times as large: k / s
  const bool known = is_known_as_kinect1(camera_);
  const bool wrong = factor > (known ? kKnown : kAssumed) || (known && factor < 1 / kKnown);
  if (!wrong) return std::nullopt;
  return InputWarning{
      InputFault::kDepthUnit,
      fmt::format(
          "the steps of depth are {:.1f} times those of a Kinect 1 at such distances, as if all depths "
          "were {:.1f} times too {}",
          factor, std::max(factor, 1 / factor), factor > 1 ? "small" : "large"),
      unit_remedy(camera_, factor, kUsual), false};
}

}  // namespace kinloop
