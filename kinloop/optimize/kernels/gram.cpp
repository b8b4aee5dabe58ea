#include "kinloop/optimize/kernels/gram.hpp"

#include "kinloop/core/errors.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/optimize/kernels/gram.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
// after it
#include <hwy/highway.h>

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kTileRows = 4;  // rows of the result accumulated at once in registers

/// Each entry of the result is summed over the rows from first to last, for any vector size.
template <size_t kWidth>
void add_of_width(const double* J, size_t count, double* result) {
  const CappedLanes<double, kWidthStep> d;
  const size_t lanes = hn::Lanes(d);
  for (size_t top = 0; top < kWidth; top += kTileRows) {
    for (size_t left = top / lanes * lanes; left < kWidth; left += lanes) {
      double* tile = result + top * kWidth + left;
      auto sum0 = hn::LoadU(d, tile), sum1 = hn::LoadU(d, tile + kWidth);
      auto sum2 = hn::LoadU(d, tile + 2 * kWidth), sum3 = hn::LoadU(d, tile + 3 * kWidth);
      for (size_t row = 0; row < count; ++row) {
        const double* values = J + row * kWidth;
        const auto right = hn::LoadU(d, values + left);
        sum0 = hn::Add(sum0, hn::Mul(hn::Set(d, values[top]), right));
        sum1 = hn::Add(sum1, hn::Mul(hn::Set(d, values[top + 1]), right));
        sum2 = hn::Add(sum2, hn::Mul(hn::Set(d, values[top + 2]), right));
        sum3 = hn::Add(sum3, hn::Mul(hn::Set(d, values[top + 3]), right));
      }
      hn::StoreU(sum0, d, tile);
      hn::StoreU(sum1, d, tile + kWidth);
      hn::StoreU(sum2, d, tile + 2 * kWidth);
      hn::StoreU(sum3, d, tile + 3 * kWidth);
    }
  }
}

void add_rows(const double* J, size_t count, size_t width, double* result) {
  switch (width) {
    case kWidthStep:
      return add_of_width<kWidthStep>(J, count, result);
    case 2 * kWidthStep:
      return add_of_width<2 * kWidthStep>(J, count, result);
    case 3 * kWidthStep:
      return add_of_width<3 * kWidthStep>(J, count, result);
    default:
      return add_of_width<kMaxGramWidth>(J, count, result);
  }
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kinloop {
namespace {

HWY_EXPORT(add_rows);

}  // namespace

void add_gram(const double* J, size_t count, size_t width, double* gram) {
  require(width > 0 && width <= kMaxGramWidth && width % kWidthStep == 0,
          "add_gram: the width is a multiple of 8, at most 32");
  HWY_DYNAMIC_DISPATCH(add_rows)(J, count, width, gram);
}

}  // namespace kinloop
#endif
