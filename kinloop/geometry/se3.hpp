#pragma once
// Rigid motions. `T_a_b` maps points of frame b to frame a: p_a = T_a_b * p_b, and T_a_c = T_a_b * T_b_c.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kinloop {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Returns the matrix with skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Returns the rotation by |omega| radians about omega.
Eigen::Quaterniond exp_so3(const Eigen::Vector3d& omega);

/// Inverse of exp_so3, with an angle in [0, pi].
Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation);

/// A rigid motion, x -> rotation * x + translation. Tangent vectors are (translation; rotation), metres and
/// radians.
struct SE3 {
  static constexpr int kDof = 6;

  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  /// Exponential map of the twist (rho; omega) (Barfoot 2017, Eq. 7.86).
  static SE3 exp(const Vector6d& twist);
  [[nodiscard]] Vector6d log() const;

  [[nodiscard]] SE3 inverse() const;
  [[nodiscard]] Eigen::Matrix3d R() const { return rotation.toRotationMatrix(); }
  [[nodiscard]] Eigen::Matrix4d matrix() const;

  /// Returns Ad with T * exp(x) = exp(Ad * x) * T.
  [[nodiscard]] Matrix6d adjoint() const;

  /// Rotation angle, in [0, pi].
  [[nodiscard]] double angle_rad() const { return log_so3(rotation).norm(); }
  [[nodiscard]] bool is_finite() const { return rotation.coeffs().allFinite() && translation.allFinite(); }
};

SE3 operator*(const SE3& a, const SE3& b);
Eigen::Vector3d operator*(const SE3& T, const Eigen::Vector3d& point);

/// Interpolates at constant twist from `a` (s = 0) to `b` (s = 1); s may lie outside [0, 1].
SE3 interpolate(const SE3& a, const SE3& b, double s);

}  // namespace kinloop
