#pragma once
// How far apart two views are.

#include <optional>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Returns the distance and the angle between two views, each relative to the largest at which they overlap;
/// nullopt if they do not.
inline std::optional<double> view_difference(const SE3& T_world_a, const SE3& T_world_b) {
  constexpr double kMaxDistance_m = 1.0, kMaxAngle_rad = 0.7;
  const double distance_m = (T_world_a.translation - T_world_b.translation).norm();
  if (distance_m > kMaxDistance_m) return std::nullopt;
  const double angle_rad = (T_world_a.inverse() * T_world_b).angle_rad();
  if (angle_rad > kMaxAngle_rad) return std::nullopt;
  return distance_m / kMaxDistance_m + angle_rad / kMaxAngle_rad;
}

}  // namespace kinloop
