#pragma once
// Rigid motions in the plane. `T_a_b` maps points of frame b to frame a, as in se3.hpp.

#include <cmath>

#include <Eigen/Core>

namespace kinloop {

/// Returns the angle wrapped to [-pi, pi].
inline double normalized_angle(double angle_rad) {
  return std::remainder(angle_rad, 2 * M_PI);
}

/// A rigid motion in the plane. Tangent vectors are (translation; angle), metres and radians.
struct SE2 {
  static constexpr int kDof = 3;

  Eigen::Vector2d translation = Eigen::Vector2d::Zero();
  double angle_rad = 0;

  [[nodiscard]] Eigen::Matrix2d R() const {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    return Eigen::Matrix2d{{c, -s}, {s, c}};
  }
  [[nodiscard]] SE2 inverse() const { return {R().transpose() * -translation, -angle_rad}; }
  [[nodiscard]] bool is_finite() const { return translation.allFinite() && std::isfinite(angle_rad); }
};

inline SE2 operator*(const SE2& a, const SE2& b) {
  return {a.translation + a.R() * b.translation, normalized_angle(a.angle_rad + b.angle_rad)};
}

}  // namespace kinloop
