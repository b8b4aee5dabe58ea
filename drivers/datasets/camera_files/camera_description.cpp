#include "drivers/datasets/camera_files/camera_description.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// False for NaN.
bool is_near(double a, double b) {
  constexpr double kTolerance = 1e-3;  // files round to three digits or more
  return std::abs(a - b) <= kTolerance * std::max(std::abs(a), std::abs(b));
}

}  // namespace

void set_intrinsics(CameraDescription& description, double fx, double fy, double cx, double cy) {
  constexpr double kMax_px = 1e6;
  const auto is_focal_length = [&](double f) { return f > 0 && f < kMax_px; };
  const auto is_centre = [&](double p) { return std::abs(p) < kMax_px; };
  if (!is_focal_length(fx) || !is_focal_length(fy) || !is_centre(cx) || !is_centre(cy)) {
    throw InputError(fmt::format("{}: fx {}, fy {}, cx {}, cy {} cannot be those of a camera; correct it",
                                 description.source, fx, fy, cx, cy));
  }
  PinholeCamera& lens = description.camera.color;
  lens.fx = fx, lens.fy = fy, lens.cx = cx, lens.cy = cy;
}

void set_size(CameraDescription& description, double width, double height) {
  const cv::Size size = checked_size(width, height, description.source);
  description.camera.color.width = size.width;
  description.camera.color.height = size.height;
}

void set_distortion(CameraDescription& description, std::span<const double> coefficients,
                    DistortionModel model) {
  constexpr double kMaxCoefficient = 1e4;
  constexpr size_t kBrown = 5, kRational = 8, kFisheye = 4, kMost = 14;
  std::vector<double> d(coefficients.begin(), coefficients.end());
  const auto reject = [&](const char* why) {
    throw InputError(
        fmt::format("{}: {}; undistort the images, or use kinloop calibrate", description.source, why));
  };
  if (!std::all_of(d.begin(), d.end(), [](double k) { return std::abs(k) <= kMaxCoefficient; }))
    reject("a distortion coefficient that is not possible");
  LensDistortion& lens = description.camera.color.lens;
  if (model == DistortionModel::kFisheye) {
    if (d.size() != kFisheye) reject("a fisheye lens without 4 coefficients");
    lens = lens_with(LensModel::kKannalaBrandt, d);
    return;
  }
  while (!d.empty() && d.back() == 0) d.pop_back();
  if (d.size() > kRational)
    reject(coefficients.size() > kMost
               ? "more than 14 distortion coefficients"
               : "the thin prism or tilted sensor model, which kinloop does not have");
  const bool rational = d.size() > kBrown;
  d.resize(rational ? kRational : kBrown, 0);
  lens = lens_with(rational ? LensModel::kRational : LensModel::kBrownConrady, d);
}

void set_depth_scale(CameraDescription& description, double factor) {
  constexpr double kFewestUnits = 100, kMostUnits = 1e5;
  const auto is_scale = [](double scale) { return scale >= kFewestUnits && scale <= kMostUnits; };
  double scale = 0;
  if (is_scale(factor)) scale = factor;
  if (is_scale(1 / factor)) scale = 1 / factor;
  if (scale == 0) return;
  constexpr double kRound = 1e-6;  // 1 / 0.001f
  description.camera.depth_scale =
      std::abs(scale - std::round(scale)) < kRound * scale ? std::round(scale) : scale;
  description.has_depth_scale = true;
}

void set_fps(CameraDescription& description, double fps) {
  constexpr double kSlowest_hz = 0.001, kFastest_hz = 1e4;
  if (!(fps >= kSlowest_hz && fps <= kFastest_hz)) return;
  description.camera.fps = fps;
  description.has_fps = true;
}

bool agree(const CameraDescription& a, const CameraDescription& b) {
  const PinholeCamera &x = a.camera.color, &y = b.camera.color;
  const bool sizes = !a.has_size() || !b.has_size() || (x.width == y.width && x.height == y.height);
  const bool units =
      !a.has_depth_scale || !b.has_depth_scale || is_near(a.camera.depth_scale, b.camera.depth_scale);
  const bool lenses = !x.has_distortion() || !y.has_distortion() || x.lens == y.lens;
  return sizes && units && lenses && is_near(x.fx, y.fx) && is_near(x.fy, y.fy) && is_near(x.cx, y.cx) &&
         is_near(x.cy, y.cy);
}

}  // namespace kinloop
