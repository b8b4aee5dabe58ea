#include "kinloop/sensor/camera/possible_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// False for NaN.
bool in(double value, double low, double high) {
  return value >= low && value <= high;
}

}  // namespace

bool is_possible(const PinholeCamera& c) {
  constexpr int kMaxSide_px = 1 << 15;
  constexpr int64_t kMaxPixels = int64_t{1} << 26;  // as for decoded images
  constexpr double kWidestShare = 0.01, kLongestShare = 1000, kMaxCentreShare = 100, kMaxCoefficient = 1e6;
  if (c.width < 1 || c.height < 1 || c.width > kMaxSide_px || c.height > kMaxSide_px) return false;
  if (int64_t{c.width} * c.height > kMaxPixels) return false;
  const double side_px = std::max(c.width, c.height);
  const auto is_focal_length = [&](double f) {
    return in(f, kWidestShare * side_px, kLongestShare * side_px);
  };
  const auto is_centre = [&](double p) { return in(std::abs(p), 0, kMaxCentreShare * side_px); };
  const LensDistortion& d = c.lens;
  const auto coefficients = {d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6};
  return is_focal_length(c.fx) && is_focal_length(c.fy) && is_centre(c.cx) && is_centre(c.cy) &&
         std::all_of(coefficients.begin(), coefficients.end(),
                     [](double k) { return in(std::abs(k), 0, kMaxCoefficient); });
}

bool is_possible(const RgbdCamera& c) {
  constexpr double kMinScale = 1e-3, kMaxScale = 1e9, kMaxRate_hz = 1e6, kMaxTime_s = 10,
                   kMaxDistance_m = 100, kTolerance = 1e-3;
  return is_possible(c.color) && (!c.depth || is_possible(*c.depth)) &&
         in(c.depth_scale, kMinScale, kMaxScale) && in(c.fps, 0, kMaxRate_hz) &&
         in(c.rolling_shutter_s.value_or(0), 0, kMaxTime_s) && in(std::abs(c.depth_delay_s), 0, kMaxTime_s) &&
         in(std::abs(c.depth_shift_m), 0, kMaxDistance_m) &&
         in(c.T_color_depth.translation.norm(), 0, kMaxDistance_m) &&
         in(c.T_color_depth.rotation.norm(), 1 - kTolerance, 1 + kTolerance);
}

void require_possible(const RgbdCamera& camera, const std::string& source) {
  if (!is_possible(camera))
    throw InputError(
        fmt::format("{}: its calibration cannot be that of a camera; use --camera FILE", source));
}

}  // namespace kinloop
