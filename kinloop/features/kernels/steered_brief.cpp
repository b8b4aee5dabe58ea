#include "kinloop/features/kernels/steered_brief.hpp"

#include <array>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/features/kernels/steered_brief.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>         // after foreach_target.h

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Memory offsets from the corner to the points (x, y) rotated by an angle and rounded to whole pixels.
void rotate_points(const float* x, const float* y, const ImageRotation& rotation, int stride,
                   int32_t* steps) {
  const CappedLanes<float, 16> d;
  const hn::Rebind<int32_t, decltype(d)> ints;
  const auto c = hn::Set(d, rotation.cosine), s = hn::Set(d, rotation.sine);
  // Adding 1.5 * 2^23 leaves the nearest integer in the low bits of the float on every instruction set.
  const auto shift = hn::Set(d, 12582912.0F);
  const auto round = [&](auto value) HWY_ATTR {
    return hn::Sub(hn::BitCast(ints, hn::Add(value, shift)), hn::BitCast(ints, shift));
  };
  for (size_t i = 0; i < kBriefTests; i += hn::Lanes(d)) {
    const auto px = hn::LoadU(d, x + i), py = hn::LoadU(d, y + i);
    const auto column = round(hn::Sub(hn::Mul(px, c), hn::Mul(py, s)));
    const auto row = round(hn::Add(hn::Mul(px, s), hn::Mul(py, c)));
    hn::StoreU(hn::Add(hn::Mul(row, hn::Set(ints, stride)), column), ints, steps + i);
  }
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kinloop {
namespace {

HWY_EXPORT(rotate_points);

}  // namespace

void describe_corner(const cv::Mat& blurred, int x, int y, float angle_deg, uint8_t* descriptor) {
  const BriefPattern& pattern = brief_pattern();
  const float angle_rad = angle_deg * static_cast<float>(std::numbers::pi / 180);
  const ImageRotation rotation{std::cos(angle_rad), std::sin(angle_rad)};
  const auto stride = static_cast<int>(blurred.step);
  std::array<int32_t, kBriefTests> first, second;
  const auto turn = HWY_DYNAMIC_DISPATCH(rotate_points);
  turn(pattern.first_x.data(), pattern.first_y.data(), rotation, stride, first.data());
  turn(pattern.second_x.data(), pattern.second_y.data(), rotation, stride, second.data());
  const uint8_t* corner = blurred.ptr<uint8_t>(y) + x;
  for (size_t byte = 0; byte < kBriefTests / 8; ++byte) {
    unsigned bits = 0;
    for (size_t bit = 0; bit < 8; ++bit) {
      const size_t i = 8 * byte + bit;
      bits |= (corner[first[i]] < corner[second[i]] ? 1U : 0U) << bit;
    }
    descriptor[byte] = static_cast<uint8_t>(bits);
  }
}

}  // namespace kinloop
#endif
