#include "kinloop/place/vocabulary/descriptor_space.hpp"

#include <limits>

namespace kinloop {
namespace {

template <class Space>
using Points = std::span<const typename Space::Point>;

template <class Space>
[[gnu::always_inline]] inline void assign(Points<Space> points, Points<Space> centres, uint32_t* nearest,
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

KINLOOP_POPCOUNT_CLONES void assign_bits(Points<HammingSpace> points, Points<HammingSpace> centres,
                                         uint32_t* nearest, uint32_t* distance) {
  assign<HammingSpace>(points, centres, nearest, distance);
}

}  // namespace

template <class Space>
void assign_to_nearest(Points<Space> points, Points<Space> centres, uint32_t* nearest, uint32_t* distance) {
  if constexpr (std::is_same_v<Space, HammingSpace>) {
    assign_bits(points, centres, nearest, distance);
  } else {
    assign<Space>(points, centres, nearest, distance);
  }
}

template void assign_to_nearest<HammingSpace>(Points<HammingSpace>, Points<HammingSpace>, uint32_t*,
                                              uint32_t*);
template void assign_to_nearest<SiftSpace>(Points<SiftSpace>, Points<SiftSpace>, uint32_t*, uint32_t*);
template void assign_to_nearest<SurfSpace>(Points<SurfSpace>, Points<SurfSpace>, uint32_t*, uint32_t*);

}  // namespace kinloop
