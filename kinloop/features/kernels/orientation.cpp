#include <array>
#include <cmath>
#include <cstdlib>

#include "kinloop/features/kernels/corner_scores.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/features/kernels/orientation.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>         // after foreach_target.h

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// For each of the 32 columns from `corner.x - 15` on: the sum of its intensities inside the disc and the sum
/// of y times intensity. `rows_inside` holds, for each |y|, 32 bytes that are all ones inside the disc.
void sum_columns(const uint8_t* corner, ptrdiff_t stride, const uint8_t* rows_inside, int16_t* sums,
                 int16_t* moments) {
  const CappedLanes<int16_t, 16> words;
  const hn::Rebind<uint8_t, decltype(words)> bytes;
  for (size_t column = 0; column < 32; column += hn::Lanes(words)) {
    const uint8_t* from = corner + column - 15;
    const auto load = [&](ptrdiff_t y) HWY_ATTR {
      const auto inside = hn::LoadU(bytes, rows_inside + std::abs(y) * 32 + static_cast<ptrdiff_t>(column));
      return hn::PromoteTo(words, hn::And(hn::LoadU(bytes, from + y * stride), inside));
    };
    auto sum = load(0);
    auto moment = hn::Zero(words);  // at most 255 * (1 + .. + 15) = 30600, which fits 16 bits
    for (ptrdiff_t y = 1; y <= 15; ++y) {
      const auto below = load(y), above = load(-y);
      sum = hn::Add(sum, hn::Add(below, above));
      moment = hn::Add(moment, hn::Mul(hn::Sub(below, above), hn::Set(words, static_cast<int16_t>(y))));
    }
    hn::StoreU(sum, words, sums + column);
    hn::StoreU(moment, words, moments + column);
  }
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <opencv2/core.hpp>

namespace kinloop {
namespace {

HWY_EXPORT(sum_columns);

constexpr size_t kColumns = 2 * kDiscMarginPx;
using RowsInside = std::array<uint8_t, (kDiscRadius + 1) * kColumns>;

/// Masks of the rows of the disc from the middle down: all ones in the columns inside it.
RowsInside make_rows_inside() {
  RowsInside inside{};
  for (int y = 0; y <= kDiscRadius; ++y) {
    const auto half_width = std::lround(std::sqrt(kDiscRadius * kDiscRadius - y * y));
    for (int column = 0; column < 2 * kDiscMarginPx; ++column) {
      const bool in = std::abs(column - kDiscRadius) <= half_width;
      inside[static_cast<size_t>(y) * kColumns + static_cast<size_t>(column)] = in ? 0xFF : 0;
    }
  }
  return inside;
}

}  // namespace

DiscMoments disc_moments(const cv::Mat& image, int x, int y) {
  static const RowsInside kRowsInside = make_rows_inside();
  std::array<int16_t, kColumns> sums, moments;
  HWY_DYNAMIC_DISPATCH(sum_columns)
  (image.ptr<uint8_t>(y) + x, static_cast<ptrdiff_t>(image.step), kRowsInside.data(), sums.data(),
   moments.data());
  DiscMoments result;
  for (size_t column = 0; column < kColumns; ++column) {
    result.m10 += (static_cast<int>(column) - kDiscRadius) * sums[column];
    result.m01 += moments[column];
  }
  return result;
}

float orientation_deg(const cv::Mat& image, int x, int y) {
  const DiscMoments moments = disc_moments(image, x, y);
  return cv::fastAtan2(static_cast<float>(moments.m01), static_cast<float>(moments.m10));
}

}  // namespace kinloop
#endif
