#pragma once
// In: rays in the frame of a solid. Out: where they enter and leave it.

#include "simulator/render/lanes.hpp"

namespace kinloop::sim {

/// Entry and exit of each ray in an infinite slab |coordinate| <= half.
struct Span {
  Lanes enter, leave;
};

inline Span slab(Lanes origin, Lanes inverse, float low, float high) {
  const Lanes a = (low - origin) * inverse;
  const Lanes b = (high - origin) * inverse;
  return {min(a, b), max(a, b)};
}

/// 1 / d without infinities, whose products with 0 would be NaN.
inline Lanes safe_inverse(Lanes d) {
  constexpr float kTiny = 1e-12F;
  const Lanes tiny = all_lanes(kTiny);
  const LaneMask too_small = (d < tiny) & (d > -tiny);
  return 1.0F / (too_small ? tiny : d);
}

inline Lanes3 safe_inverse(const Lanes3& d) {
  return {safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z)};
}

inline Span box_span(const Lanes3& o, const Lanes3& inverse, const float half[3]) {
  const Span x = slab(o.x, inverse.x, -half[0], half[0]);
  const Span y = slab(o.y, inverse.y, -half[1], half[1]);
  const Span z = slab(o.z, inverse.z, -half[2], half[2]);
  return {max(max(x.enter, y.enter), z.enter), min(min(x.leave, y.leave), z.leave)};
}

/// Intersection around the closest approach, which keeps digits that the textbook quadratic loses (Haines et
/// al. 2019, "Precision improvements for ray/sphere intersection"). Empty span if the ray misses.
inline Span round_span(Lanes along, Lanes direction_squared, Lanes miss_squared, float radius) {
  constexpr float kTiny = 1e-20F;
  const Lanes inverse = 1.0F / max(direction_squared, all_lanes(kTiny));
  const Lanes discriminant = (radius * radius - miss_squared) * inverse;
  const Lanes half_chord = sqrt(max(discriminant, all_lanes(0)));
  const Lanes none = all_lanes(-1);
  return {discriminant > 0 ? along - half_chord : -none, discriminant > 0 ? along + half_chord : none};
}

inline Span cylinder_span(const Lanes3& o, const Lanes3& d, const float half[3]) {
  constexpr float kTiny = 1e-20F;
  const Lanes dd = d.x * d.x + d.y * d.y;
  const Lanes along = -(o.x * d.x + o.y * d.y) / max(dd, all_lanes(kTiny));
  const Lanes x = o.x + along * d.x;
  const Lanes y = o.y + along * d.y;
  const Span side = round_span(along, dd, x * x + y * y, half[0]);
  const Span caps = slab(o.z, safe_inverse(d.z), -half[2], half[2]);
  return {max(side.enter, caps.enter), min(side.leave, caps.leave)};
}

inline Span sphere_span(const Lanes3& o, const Lanes3& d, const float half[3]) {
  const Lanes dd = d.x * d.x + d.y * d.y + d.z * d.z;
  const Lanes along = -(o.x * d.x + o.y * d.y + o.z * d.z) / dd;
  const Lanes x = o.x + along * d.x;
  const Lanes y = o.y + along * d.y;
  const Lanes z = o.z + along * d.z;
  return round_span(along, dd, x * x + y * y + z * z, half[0]);
}

/// A sphere of radius 1 for rays that are scaled like the ellipsoid, which leaves t as it is.
inline Span ellipsoid_span(const Lanes3& o, const Lanes3& d, const float half[3]) {
  constexpr float kUnit[3] = {1, 1, 1};
  const float x = 1 / half[0], y = 1 / half[1], z = 1 / half[2];
  return sphere_span({x * o.x, y * o.y, z * o.z}, {x * d.x, y * d.y, z * d.z}, kUnit);
}

}  // namespace kinloop::sim
