#include "kinloop/optimize/kernels/bundle_products.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/optimize/kernels/bundle_products.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
// after it
#include <hwy/highway.h>

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr size_t kObservations = ObservationBlock::kSize;
using Eight = CappedLanes<double, kObservations>;
static_assert(kObservations == kEliminatedWidth);

constexpr size_t kTile = 4;  // rows of the result that share the loads of a column

/// The four values of `sums`, `stride` apart, to which the products of a column with four others are added.
/// Sums rows from `first_row` on: the first two are zero in columns that only depth depends on.
template <size_t kFirstRow>
HWY_INLINE void add_tile(const double* left, const double* right, size_t row_size, size_t stride,
                         double* sums) {
  const Eight d;
  for (size_t lane = 0; lane < kObservations; lane += hn::Lanes(d)) {
    double* to = sums + lane;
    auto sum0 = hn::LoadU(d, to), sum1 = hn::LoadU(d, to + stride);
    auto sum2 = hn::LoadU(d, to + 2 * stride), sum3 = hn::LoadU(d, to + 3 * stride);
    for (size_t row = kFirstRow; row < kRowsPerObservation; ++row) {
      const double* a = left + row * row_size + lane;
      const auto b = hn::LoadU(d, right + row * row_size + lane);
      sum0 = hn::Add(sum0, hn::Mul(hn::LoadU(d, a), b));
      sum1 = hn::Add(sum1, hn::Mul(hn::LoadU(d, a + kObservations), b));
      sum2 = hn::Add(sum2, hn::Mul(hn::LoadU(d, a + 2 * kObservations), b));
      sum3 = hn::Add(sum3, hn::Mul(hn::LoadU(d, a + 3 * kObservations), b));
    }
    hn::StoreU(sum0, d, to);
    hn::StoreU(sum1, d, to + stride);
    hn::StoreU(sum2, d, to + 2 * stride);
    hn::StoreU(sum3, d, to + 3 * stride);
  }
}

void add_gram_of_block(const GramColumns& layout, const double* columns, double* sums) {
  const size_t count = layout.count, row_size = layout.width * kObservations;
  const size_t stride = count * kObservations;
  for (size_t top = 0; top < count; top += kTile) {
    const double* left = columns + top * kObservations;
    double* row = sums + top * stride;
    size_t j = top;
    for (; j < layout.pixel_end; ++j) {
      add_tile<0>(left, columns + j * kObservations, row_size, stride, row + j * kObservations);
    }
    for (; j < count; ++j) {
      add_tile<2>(left, columns + j * kObservations, row_size, stride, row + j * kObservations);
    }
  }
}

/// Writes the product of two columns to `products`.
HWY_INLINE void write_product(const double* a, const double* b, size_t row_size, bool depth_only,
                              double* product) {
  const Eight d;
  for (size_t lane = 0; lane < kObservations; lane += hn::Lanes(d)) {
    const size_t depth = 2 * row_size + lane;
    auto sum = hn::Mul(hn::LoadU(d, a + depth), hn::LoadU(d, b + depth));
    if (!depth_only) {
      sum = hn::Add(sum, hn::Mul(hn::LoadU(d, a + lane), hn::LoadU(d, b + lane)));
      sum = hn::Add(sum, hn::Mul(hn::LoadU(d, a + row_size + lane), hn::LoadU(d, b + row_size + lane)));
    }
    hn::StoreU(sum, d, product + lane);
  }
}

void write_products(const LinearColumns& layout, const double* columns,
                    const std::array<double*, kObservations>& records) {
  HWY_ALIGN double products[3 * LinearColumns::kMaxWidth * kObservations];
  const size_t row_size = layout.width * kObservations;
  const auto column = [&](size_t index) { return columns + index * kObservations; };
  double* next = products;
  const auto add = [&](size_t left, size_t right) {
    const bool depth_only = right >= layout.pixel_end && right < layout.used;
    write_product(column(left), column(right), row_size, depth_only, next);
    next += kObservations;
  };
  const size_t point = *layout.point;
  for (size_t i = 0; i < 3; ++i)
    for (size_t c = 0; c < LinearColumns::kResidual; ++c) add(point + i, c);
  for (size_t i = 0; i < 3; ++i)
    for (size_t c = LinearColumns::kResidual; c < point; ++c) add(point + i, c);
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = i; j < 3; ++j) add(point + i, point + j);
  const auto size = static_cast<size_t>(next - products) / kObservations;
  for (size_t lane = 0; lane < kObservations; ++lane) {
    double* record = records[lane];
    for (size_t i = 0; i < size; ++i) record[i] = products[i * kObservations + lane];
  }
}

void eliminate(const PointFactor& f, const double* records, size_t record_size, size_t count, double* U) {
  const Eight d;
  const auto l10 = hn::Set(d, f.l10), l20 = hn::Set(d, f.l20), l21 = hn::Set(d, f.l21);
  const auto i00 = hn::Set(d, f.i00), i11 = hn::Set(d, f.i11), i22 = hn::Set(d, f.i22);
  for (size_t slot = 0; slot < count; ++slot) {
    for (size_t lane = 0; lane < kEliminatedWidth; lane += hn::Lanes(d)) {
      // The last two values of each are of the next axis, and of no use.
      const double* W = records + slot * record_size + lane;
      double* to = U + slot * kEliminatedSize + lane;
      const auto u0 = hn::Mul(hn::LoadU(d, W), i00);
      const auto u1 = hn::Mul(hn::Sub(hn::LoadU(d, W + 6), hn::Mul(l10, u0)), i11);
      const auto w2 = hn::Sub(hn::LoadU(d, W + 12), hn::Mul(l20, u0));
      const auto u2 = hn::Mul(hn::Sub(w2, hn::Mul(l21, u1)), i22);
      hn::StoreU(u0, d, to);
      hn::StoreU(u1, d, to + kEliminatedWidth);
      hn::StoreU(u2, d, to + 2 * kEliminatedWidth);
    }
  }
}

/// Adds u' v, with three values of u for each column of the result, to columns of eight values.
template <class Left>
HWY_INLINE void add_outer(const double* v, const Left& left, size_t columns, double* sums) {
  const Eight d;
  for (size_t lane = 0; lane < kEliminatedWidth; lane += hn::Lanes(d)) {
    const auto v0 = hn::LoadU(d, v + lane), v1 = hn::LoadU(d, v + kEliminatedWidth + lane);
    const auto v2 = hn::LoadU(d, v + 2 * kEliminatedWidth + lane);
    for (size_t c = 0; c < columns; ++c) {
      double* to = sums + c * kEliminatedWidth + lane;
      auto sum = hn::Add(hn::LoadU(d, to), hn::Mul(hn::Set(d, left(0, c)), v0));
      sum = hn::Add(sum, hn::Mul(hn::Set(d, left(1, c)), v1));
      hn::StoreU(hn::Add(sum, hn::Mul(hn::Set(d, left(2, c)), v2)), d, to);
    }
  }
}

void add_column(const SchurColumn& column, double* blocks, double* right) {
  for (const SchurColumn::Slot& slot : column.slots) {
    const double* own = column.U + slot.own * kEliminatedSize;
    const double* border = column.border + slot.point * 3 * column.border_stride;
    add_outer(
        own, [&](size_t axis, size_t c) HWY_ATTR { return border[axis * column.border_stride + c]; },
        column.border_count, right);
    const auto own_value = [&](size_t axis, size_t c) HWY_ATTR { return own[axis * kEliminatedWidth + c]; };
    for (size_t other = slot.first; other < slot.last; ++other) {
      const auto camera = static_cast<size_t>(column.camera_of_slot[other]);
      add_outer(column.U + other * kEliminatedSize, own_value, 6,
                blocks + column.block_of_camera[camera] * kSchurBlockSize);
    }
  }
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kinloop {
namespace {

HWY_EXPORT(add_gram_of_block);
HWY_EXPORT(write_products);
HWY_EXPORT(eliminate);
HWY_EXPORT(add_column);

}  // namespace

PointFactor::PointFactor(const std::array<double, 6>& H) {
  constexpr double kMinPivot = 1e-12;  // relative: rounding errors of the elimination
  const double d0 = H[0];
  if (!(d0 > 0)) return;
  const double r00 = 1 / std::sqrt(d0);
  const double m10 = H[1] * r00, m20 = H[2] * r00;
  const double d1 = H[3] - m10 * m10;
  if (!(d1 > kMinPivot * H[3])) return;
  const double r11 = 1 / std::sqrt(d1);
  const double m21 = (H[4] - m20 * m10) * r11;
  const double d2 = H[5] - m20 * m20 - m21 * m21;
  if (!(d2 > kMinPivot * H[5])) return;
  l10 = m10;
  l20 = m20;
  l21 = m21;
  i00 = r00;
  i11 = r11;
  i22 = 1 / std::sqrt(d2);
}

Eigen::MatrixXd gram_of_sums(const GramColumns& layout, std::span<const double> sums) {
  const auto size = static_cast<Eigen::Index>(layout.count);
  Eigen::MatrixXd gram(size, size);
  for (size_t i = 0; i < layout.count; ++i) {
    for (size_t j = i; j < layout.count; ++j) {
      double sum = 0;
      for (size_t lane = 0; lane < ObservationBlock::kSize; ++lane) {
        sum += sums[(i * layout.count + j) * ObservationBlock::kSize + lane];
      }
      gram(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = sum;
    }
  }
  return gram;
}

void add_block_gram(const GramColumns& layout, const double* columns, double* sums) {
  HWY_DYNAMIC_DISPATCH(add_gram_of_block)(layout, columns, sums);
}

void write_point_products(const LinearColumns& layout, const double* columns,
                          const std::array<double*, ObservationBlock::kSize>& records) {
  HWY_DYNAMIC_DISPATCH(write_products)(layout, columns, records);
}

void eliminate_point(const PointFactor& factor, const double* records, size_t record_size, size_t count,
                     double* U) {
  HWY_DYNAMIC_DISPATCH(eliminate)(factor, records, record_size, count, U);
}

void add_schur_column(const SchurColumn& column, double* blocks, double* right) {
  HWY_DYNAMIC_DISPATCH(add_column)(column, blocks, right);
}

}  // namespace kinloop
#endif
