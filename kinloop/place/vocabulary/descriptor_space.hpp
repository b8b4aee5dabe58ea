#pragma once
// In: descriptors as plain values. Out: their distances and means, in integers, so that sums do not depend on
// the order of summation across threads and processes.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kinloop/core/errors.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/place/vocabulary/descriptor_kind.hpp"

namespace kinloop {

/// One ORB descriptor: 256 bits, compared by Hamming distance.
using BinaryDescriptor = std::array<uint8_t, kOrbBytes>;

/// 256 bits; the distance is the number of differing bits, which equals the squared Euclidean distance.
struct HammingSpace {
  using Point = BinaryDescriptor;
  static constexpr uint32_t kMaxDistance = kOrbBytes * 8;
  static constexpr size_t kCounts = kOrbBytes * 8;  ///< counters of `add`: points with each bit set

  static uint32_t distance(const Point& a, const Point& b) {
    return static_cast<uint32_t>(hamming_distance(a.data(), b.data()));
  }
  static void add(const Point& point, uint64_t* counts) {
    for (size_t byte = 0; byte < point.size(); ++byte) {
      for (size_t bit = 0; bit < 8; ++bit) counts[8 * byte + bit] += (uint32_t{point[byte]} >> bit) & 1U;
    }
  }
  /// The bitwise majority, which minimises the sum of distances; on ties keeps the bit of `current`.
  static Point mean(const uint64_t* counts, uint64_t points, const Point& current) {
    Point centre{};
    for (size_t bit = 0; bit < kCounts; ++bit) {
      const uint64_t twice = 2 * counts[bit];
      const bool one = twice == points ? ((current[bit / 8] >> (bit % 8)) & 1) != 0 : twice > points;
      if (one) centre[bit / 8] = static_cast<uint8_t>(centre[bit / 8] | (1U << (bit % 8)));
    }
    return centre;
  }
};

/// N components of one byte; the distance is the squared Euclidean one.
template <size_t N>
struct EuclideanSpace {
  using Point = std::array<uint8_t, N>;
  static constexpr uint32_t kMaxDistance = N * 255 * 255;
  static constexpr size_t kCounts = N;  ///< counters of `add`: sum of each component

  static uint32_t distance(const Point& a, const Point& b) {
    int sum = 0;
    for (size_t i = 0; i < N; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return static_cast<uint32_t>(sum);
  }
  static void add(const Point& point, uint64_t* counts) {
    for (size_t i = 0; i < N; ++i) counts[i] += point[i];
  }
  /// The rounded mean, which minimises the sum of squared distances over all integer points.
  static Point mean(const uint64_t* counts, uint64_t points, const Point& /*current*/) {
    Point centre{};
    for (size_t i = 0; i < N; ++i) centre[i] = static_cast<uint8_t>((2 * counts[i] + points) / (2 * points));
    return centre;
  }
};

using SiftSpace = EuclideanSpace<128>;
using SurfSpace = EuclideanSpace<64>;

/// Calls `work` with the space of the kind: `dispatch_space(kind, []<class Space>(Space) {...})`.
template <class Work>
auto dispatch_space(DescriptorKind kind, Work&& work) {
  switch (kind) {
    case DescriptorKind::kSift:
      return work(SiftSpace{});
    case DescriptorKind::kSurf:
      return work(SurfSpace{});
    default:
      return work(HammingSpace{});
  }
}

/// Reinterprets bytes as points; their number must be a multiple of the point size.
template <class Space>
std::span<const typename Space::Point> as_points(std::span<const uint8_t> rows) {
  using Point = typename Space::Point;
  static_assert(sizeof(Point) == std::tuple_size_v<Point> && alignof(Point) == 1);
  require(rows.size() % sizeof(Point) == 0, "as_points: not a whole number of descriptors");
  return {reinterpret_cast<const Point*>(rows.data()), rows.size() / sizeof(Point)};
}

/// Writes to `nearest[i]` and `distance[i]` the centre nearest to point i (ties to the first) and its
/// distance.
template <class Space>
void assign_to_nearest(std::span<const typename Space::Point> points,
                       std::span<const typename Space::Point> centres, uint32_t* nearest, uint32_t* distance);

}  // namespace kinloop
