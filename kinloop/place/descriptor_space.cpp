#include "kinloop/place/descriptor_space.hpp"

#include <limits>

namespace kinloop {
namespace {

template <class Space>
[[gnu::always_inline]] inline void assign(std::span<const typename Space::Point> points,
                                          std::span<const typename Space::Point> centres, uint32_t* nearest,
                                          uint32_t* distance) {
  for (size_t i = 0; i < points.size(); ++i) {
    uint32_t best = std::numeric_limits<uint32_t>::max();
    for (size_t j = 0; j < centres.size(); ++j) {
      const uint32_t candidate = Space::distance(points[i], centres[j]);
      if (candidate < best) {
        best = candidate;
        nearest[i] = static_cast<uint32_t>(j);
      }
    }
    distance[i] = best;
  }
}

}  // namespace

template <>
KINLOOP_POPCOUNT_CLONES void assign_to_nearest<HammingSpace>(std::span<const BinaryDescriptor> points,
                                                             std::span<const BinaryDescriptor> centres,
                                                             uint32_t* nearest, uint32_t* distance) {
  assign<HammingSpace>(points, centres, nearest, distance);
}

template <>
void assign_to_nearest<SiftSpace>(std::span<const SiftSpace::Point> points,
                                  std::span<const SiftSpace::Point> centres, uint32_t* nearest,
                                  uint32_t* distance) {
  assign<SiftSpace>(points, centres, nearest, distance);
}

template <>
void assign_to_nearest<SurfSpace>(std::span<const SurfSpace::Point> points,
                                  std::span<const SurfSpace::Point> centres, uint32_t* nearest,
                                  uint32_t* distance) {
  assign<SurfSpace>(points, centres, nearest, distance);
}

}  // namespace kinloop
