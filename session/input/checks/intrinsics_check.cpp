#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "session/input/checks/checks.hpp"

namespace kinloop {
namespace {

/// A ratio of usual image sizes, by name.
struct SizeFactor {
  double value;
  const char* name;
};

constexpr std::array<SizeFactor, 8> kSizeFactors = {{{0.25, "a quarter"},
                                                     {1.0 / 3, "a third"},
                                                     {0.5, "half"},
                                                     {2.0 / 3, "two thirds"},
                                                     {1.5, "1.5 times"},
                                                     {2, "the double"},
                                                     {3, "three times"},
                                                     {4, "four times"}}};

/// The usual factor nearest to this one, which is not exact since principal points are not in the middle.
std::optional<SizeFactor> usual_factor(double factor) {
  constexpr double kSame = 0.08;
  for (const SizeFactor& usual : kSizeFactors) {
    if (std::abs(factor / usual.value - 1) < kSame) return usual;
  }
  return std::nullopt;
}

std::string intrinsics_text(const PinholeCamera& c, double factor) {
  return fmt::format("fx {:.1f}, fy {:.1f}, cx {:.1f}, cy {:.1f}", factor * c.fx, factor * c.fy,
                     factor * c.cx, factor * c.cy);
}

std::string size_text(const PinholeCamera& c) {
  return fmt::format("{} x {}", c.width, c.height);
}

/// The factor that brings the principal point to the middle, if there is one.
std::optional<double> fitting_factor(const PinholeCamera& c) {
  constexpr double kAgreement = 1.12, kMin = 0.1, kMax = 10;
  if (!(c.cx > 0) || !(c.cy > 0)) return std::nullopt;
  const double x = 0.5 * (c.width - 1) / c.cx, y = 0.5 * (c.height - 1) / c.cy, factor = std::sqrt(x * y);
  const double apart = std::max(x, y) / std::min(x, y);
  return apart < kAgreement && factor > kMin && factor < kMax ? std::optional(factor) : std::nullopt;
}

}  // namespace

std::optional<InputWarning> check_intrinsics(const PinholeCamera& c) {
  // A lens that is 20 % of the image off its middle leaves part of the image dark; only crops do that.
  constexpr double kMaxOffset = 0.2, kNarrowest = 3, kWidest = 0.15;
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double middle_x = 0.5 * (c.width - 1), middle_y = 0.5 * (c.height - 1);
  const bool is_off =
      std::abs(c.cx - middle_x) > kMaxOffset * c.width || std::abs(c.cy - middle_y) > kMaxOffset * c.height;
  if (is_off) {
    const std::string evidence = fmt::format(
        "the principal point ({:.1f}, {:.1f}) is far from the middle of "
        "images of {}",
        c.cx, c.cy, size_text(c));
    if (const auto factor = fitting_factor(c)) {
      const auto usual = usual_factor(*factor);
      const std::string name = usual ? usual->name : fmt::format("{:.2f} times", *factor);
      return InputWarning{InputFault::kIntrinsics,
                          evidence + ": the camera file is that of another image size",
                          fmt::format("{} of all values fits these images: {}", name,
                                      intrinsics_text(c, usual ? usual->value : *factor)),
                          false};
    }
    return InputWarning{
        InputFault::kIntrinsics, evidence,
        fmt::format("unless they are cropped, use about cx {:.1f}, cy {:.1f}", middle_x, middle_y), false};
  }
  const double share = c.fx / c.width;
  if (share > kWidest && share < kNarrowest) return std::nullopt;
  return InputWarning{InputFault::kIntrinsics,
                      fmt::format("with fx {:.1f} for images of {}, the field of view is {:.0f} degrees wide",
                                  c.fx, size_text(c), 2 * kDegrees * std::atan(0.5 / share)),
                      "RGB-D cameras see 40 to 120 degrees: check fx and fy in camera.yaml", false};
}

}  // namespace kinloop
