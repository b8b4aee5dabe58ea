#include "kinloop/features/kernels/gaussian_blur.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kinloop/core/errors.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/features/kernels/gaussian_blur.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>         // after foreach_target.h

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = CappedLanes<float, 16>;
using Ints = hn::Rebind<int32_t, Floats>;
using Bytes = hn::Rebind<uint8_t, Floats>;

/// Weighted sum of seven neighbours; those at equal distance from the middle are already added in pairs.
template <class V>
HWY_INLINE V weigh(const float* weights, V middle, V next, V second, V third) {
  const Floats d;
  const V inner = hn::Add(hn::Mul(middle, hn::Set(d, weights[0])), hn::Mul(next, hn::Set(d, weights[1])));
  return hn::Add(inner,
                 hn::Add(hn::Mul(second, hn::Set(d, weights[2])), hn::Mul(third, hn::Set(d, weights[3]))));
}

/// Blurs a row horizontally: `width` pixels from `row` on; reads three more on either side.
void blur_along(const uint8_t* row, int width, const float* weights, float* blurred) {
  const Floats d;
  const Ints ints;
  const Bytes bytes;
  const int last = width - static_cast<int>(hn::Lanes(d));  // the last vector overlaps the previous one
  for (int begin = 0; begin < width; begin += static_cast<int>(hn::Lanes(d))) {
    const uint8_t* at = row + std::min(begin, last);
    const auto load = [&](int offset) HWY_ATTR { return hn::PromoteTo(ints, hn::LoadU(bytes, at + offset)); };
    const auto both = [&](int offset)
                          HWY_ATTR { return hn::ConvertTo(d, hn::Add(load(-offset), load(offset))); };
    hn::StoreU(weigh(weights, hn::ConvertTo(d, load(0)), both(1), both(2), both(3)), d, blurred + (at - row));
  }
}

/// Blurs seven rows vertically, centred on rows[3], and rounds to nearest, ties to even.
void blur_across(const float* const* rows, int width, const float* weights, uint8_t* blurred) {
  const Floats d;
  const Ints ints;
  const Bytes bytes;
  // Adding 1.5 * 2^23 leaves the nearest integer in the low bits of the float on every instruction set.
  const auto shift = hn::Set(d, 12582912.0F);
  const int last = width - static_cast<int>(hn::Lanes(d));
  for (int begin = 0; begin < width; begin += static_cast<int>(hn::Lanes(d))) {
    const int x = std::min(begin, last);
    const auto load = [&](size_t row) HWY_ATTR { return hn::LoadU(d, rows[row] + x); };
    const auto both = [&](size_t offset) HWY_ATTR { return hn::Add(load(3 - offset), load(3 + offset)); };
    const auto sum = weigh(weights, load(3), both(1), both(2), both(3));
    const auto rounded = hn::Sub(hn::BitCast(ints, hn::Add(sum, shift)), hn::BitCast(ints, shift));
    hn::StoreU(hn::DemoteTo(bytes, rounded), bytes, blurred + x);
  }
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kinloop {
namespace {

HWY_EXPORT(blur_along);
HWY_EXPORT(blur_across);

constexpr int kMinWidth = 16;  // of the computed part: the widest vector
constexpr int kTaps = 2 * kBlurRadius + 1;

/// Weights of the centre and of the pixels at distance 1, 2 and 3; all seven sum to 1.
std::array<float, kBlurRadius + 1> gaussian_weights() {
  constexpr double kSigma = 2;
  std::array<double, kBlurRadius + 1> weights;
  double sum = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    weights[i] = std::exp(-0.5 * static_cast<double>(i * i) / (kSigma * kSigma));
    sum += i == 0 ? weights[i] : 2 * weights[i];
  }
  std::array<float, kBlurRadius + 1> normalised;
  for (size_t i = 0; i < weights.size(); ++i) normalised[i] = static_cast<float>(weights[i] / sum);
  return normalised;
}

}  // namespace

cv::Mat gaussian_blur(const cv::Mat& image) {
  require(image.type() == CV_8UC1, "gaussian_blur: the image must be 8-bit grey");
  const int width = image.cols - 2 * kBlurRadius;
  cv::Mat blurred(image.size(), CV_8UC1);
  if (width < kMinWidth || image.rows < kTaps) {
    image.copyTo(blurred);
    return blurred;
  }
  const auto weights = gaussian_weights();
  for (int y = 0; y < kBlurRadius; ++y) {
    image.row(y).copyTo(blurred.row(y));
    image.row(image.rows - 1 - y).copyTo(blurred.row(image.rows - 1 - y));
  }
  // Horizontally blurred rows, the latest seven.
  std::array<std::vector<float>, kTaps> ring;
  ring.fill(std::vector<float>(static_cast<size_t>(width)));
  for (int y = 0; y < image.rows; ++y) {
    const uint8_t* row = image.ptr<uint8_t>(y);
    HWY_DYNAMIC_DISPATCH(blur_along)
    (row + kBlurRadius, width, weights.data(), ring[static_cast<size_t>(y % kTaps)].data());
    const int middle = y - kBlurRadius;
    if (middle < kBlurRadius) continue;
    std::array<const float*, kTaps> rows;
    for (int i = 0; i < kTaps; ++i) {
      rows[static_cast<size_t>(i)] = ring[static_cast<size_t>((middle - kBlurRadius + i) % kTaps)].data();
    }
    uint8_t* out = blurred.ptr<uint8_t>(middle);
    HWY_DYNAMIC_DISPATCH(blur_across)(rows.data(), width, weights.data(), out + kBlurRadius);
    const uint8_t* original = image.ptr<uint8_t>(middle);
    std::copy_n(original, kBlurRadius, out);
    std::copy_n(original + image.cols - kBlurRadius, kBlurRadius, out + image.cols - kBlurRadius);
  }
  return blurred;
}

}  // namespace kinloop
#endif
