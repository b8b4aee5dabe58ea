#include "kinloop/features/kernels/hamming_rows.hpp"

#include <algorithm>

#include "kinloop/features/hamming.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/features/kernels/hamming_rows.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>         // after foreach_target.h

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void to_rows(const uint8_t* query, const uint8_t* rows, const uint32_t* indices, size_t count,
             uint16_t* distances) {
  const CappedLanes<uint64_t, 4> d;
  constexpr size_t kWords = kOrbBytes / sizeof(uint64_t);
  const auto load = [d](const uint8_t* bytes, size_t word)
                        HWY_ATTR { return hn::LoadU(d, reinterpret_cast<const uint64_t*>(bytes) + word); };
  for (size_t i = 0; i < count; ++i) {
    const uint8_t* row = rows + size_t{indices[i]} * kOrbBytes;
    auto bits = hn::Zero(d);
    for (size_t word = 0; word < kWords; word += hn::Lanes(d)) {
      bits = hn::Add(bits, hn::PopulationCount(hn::Xor(load(query, word), load(row, word))));
    }
    distances[i] = static_cast<uint16_t>(hn::GetLane(hn::SumOfLanes(d, bits)));
  }
}

using Bytes = CappedLanes<uint8_t, 64>;
using ByteVector = hn::Vec<Bytes>;

/// Bitwise full adder: `sum` gets the low bits of the result; returns the carries.
HWY_INLINE ByteVector add_bits(ByteVector& sum, ByteVector b, ByteVector c) {
  const ByteVector a = sum, differ = hn::Xor(a, b);
  sum = hn::Xor(differ, c);
  return hn::Or(hn::And(a, b), hn::And(differ, c));
}

/// Distances from a query to transposed descriptors, a whole vector at a time. Counting bits is expensive and
/// bitwise addition is cheap: carry-save adders reduce eight vectors to one that is counted and three that
/// stay in the adders (Harley and Seal, in Warren 2012, section 5-1).
void to_transposed(const uint8_t* query, const uint8_t* transposed, size_t stride, uint16_t* distances) {
  const Bytes d;
  const CappedLanes<uint16_t, 32> words;
  const hn::Rebind<uint8_t, decltype(words)> half;
  const auto twice = [](auto v) HWY_ATTR { return hn::Add(v, v); };
  for (size_t begin = 0; begin < stride; begin += hn::Lanes(d)) {
    const auto differ = [&](size_t byte) HWY_ATTR {
      return hn::Xor(hn::Set(d, query[byte]), hn::LoadU(d, transposed + byte * stride + begin));
    };
    ByteVector ones = hn::Zero(d), twos = ones, fours = ones, eights = ones;  // `eights` ends up as a count
    for (size_t byte = 0; byte < kOrbBytes; byte += 8) {
      const auto four_bytes = [&](size_t from) HWY_ATTR {
        const ByteVector low = add_bits(ones, differ(from), differ(from + 1));
        const ByteVector high = add_bits(ones, differ(from + 2), differ(from + 3));
        return add_bits(twos, low, high);
      };
      const ByteVector low = four_bytes(byte), high = four_bytes(byte + 4);
      eights = hn::Add(eights, hn::PopulationCount(add_bits(fours, low, high)));
    }
    // All 256 bits would overflow a byte, so the last sum uses 16-bit words.
    const ByteVector pairs =
        hn::Add(twice(hn::Add(twice(eights), hn::PopulationCount(fours))), hn::PopulationCount(twos));
    HWY_ALIGN uint8_t pair_counts[64], single_counts[64];
    hn::Store(pairs, d, pair_counts);
    hn::Store(hn::PopulationCount(ones), d, single_counts);
    for (size_t i = 0; i < hn::Lanes(d); i += hn::Lanes(words)) {
      const auto even = twice(hn::PromoteTo(words, hn::LoadU(half, pair_counts + i)));
      const auto single = hn::PromoteTo(words, hn::LoadU(half, single_counts + i));
      hn::StoreU(hn::Add(even, single), words, distances + begin + i);
    }
  }
}

/// See nearest_key in the header.
uint32_t lower_keys(const uint16_t* distances, size_t count, uint32_t index, uint32_t* keys) {
  const CappedLanes<uint32_t, 16> d;
  const hn::Rebind<uint16_t, decltype(d)> words;
  auto columns = hn::Iota(d, 0);
  auto smallest = hn::Set(d, kNoKey);
  for (size_t j = 0; j < count; j += hn::Lanes(d)) {
    const auto distance = hn::ShiftLeft<kIndexBits>(hn::PromoteTo(d, hn::LoadU(words, distances + j)));
    smallest = hn::Min(smallest, hn::Or(distance, columns));
    hn::StoreU(hn::Min(hn::LoadU(d, keys + j), hn::Or(distance, hn::Set(d, index))), d, keys + j);
    columns = hn::Add(columns, hn::Set(d, static_cast<uint32_t>(hn::Lanes(d))));
  }
  return hn::GetLane(hn::MinOfLanes(d, smallest));
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kinloop {
namespace {

HWY_EXPORT(to_rows);
HWY_EXPORT(to_transposed);
HWY_EXPORT(lower_keys);

constexpr size_t kWidestVector = 64;

}  // namespace

void hamming_to_rows(const uint8_t* query, const uint8_t* rows, std::span<const uint32_t> indices,
                     uint16_t* distances) {
  HWY_DYNAMIC_DISPATCH(to_rows)(query, rows, indices.data(), indices.size(), distances);
}

uint32_t nearest_key(std::span<const uint16_t> distances, uint32_t index, uint32_t* keys) {
  return HWY_DYNAMIC_DISPATCH(lower_keys)(distances.data(), distances.size(), index, keys);
}

TransposedDescriptors::TransposedDescriptors(const uint8_t* rows, size_t count)
    : count_(count),
      stride_((count + kWidestVector - 1) / kWidestVector * kWidestVector),
      bytes_(stride_ * kOrbBytes) {
  for (size_t i = 0; i < count; ++i) {
    for (size_t byte = 0; byte < kOrbBytes; ++byte) bytes_[byte * stride_ + i] = rows[i * kOrbBytes + byte];
  }
}

void TransposedDescriptors::distances_from(const uint8_t* query, std::span<uint16_t> distances) const {
  HWY_DYNAMIC_DISPATCH(to_transposed)(query, bytes_.data(), stride_, distances.data());
  std::fill(distances.begin() + static_cast<long>(count_), distances.end(), kInvalidDistance);
}

}  // namespace kinloop
#endif
