#pragma once
// SIMD vectors of four floats (GCC and Clang vector extensions): one packet holds the sub-exposures of one
// pixel, or four neighbouring pixels. Plain IEEE arithmetic, so results do not depend on the machine.

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace kinloop::sim {

constexpr int kLanes = 4;
using Lanes = float __attribute__((vector_size(16)));
using LaneMask = int32_t __attribute__((vector_size(16)));  ///< -1 where true, 0 where false

inline Lanes all_lanes(float value) {
  return Lanes{value, value, value, value};
}
inline Lanes min(Lanes a, Lanes b) {
  return a < b ? a : b;
}
inline Lanes max(Lanes a, Lanes b) {
  return a > b ? a : b;
}
inline Lanes sqrt(Lanes a) {
  return Lanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
inline bool any(LaneMask mask) {
  const auto halves = std::bit_cast<std::array<uint64_t, 2>>(mask);
  return (halves[0] | halves[1]) != 0;
}

/// Three coordinates of four points or directions.
struct Lanes3 {
  Lanes x, y, z;
};

inline Lanes3 all_lanes3(float value) {
  return {all_lanes(value), all_lanes(value), all_lanes(value)};
}
inline Lanes3 min(const Lanes3& a, const Lanes3& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
inline Lanes3 max(const Lanes3& a, const Lanes3& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}

/// Points `origin + t * direction`; t is in units of the direction's length, which need not be 1.
struct RayPacket {
  Lanes3 origin, direction;
};

/// First hits of the rays of a packet.
struct HitPacket {
  Lanes t;             ///< the limit if nothing was hit
  LaneMask primitive;  ///< index of the primitive, -1 if nothing was hit
};

}  // namespace kinloop::sim
