#include "kinloop/geometry/se3.hpp"

#include <cmath>

namespace kinloop {
namespace {

constexpr double kSmallAngle = 1e-5;  // below it, second-order series are exact in double precision

/// Left Jacobian of SO(3): V with exp((rho; omega)).translation = V * rho.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const Eigen::Matrix3d W = skew(omega);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double s = std::sin(0.5 * angle) / angle;
  const double a = 2.0 * s * s;  // (1 - cos) / angle^2 without cancellation at small angles
  const double b = (angle - std::sin(angle)) / (angle * angle * angle);
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const Eigen::Matrix3d W = skew(omega);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() - 0.5 * W + W * W / 12.0;
  const double half = 0.5 * angle;
  const double b = (1.0 - half * std::cos(half) / std::sin(half)) / (angle * angle);
  return Eigen::Matrix3d::Identity() - 0.5 * W + b * W * W;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const double half = 0.5 * angle;
  const double s = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  return Eigen::Quaterniond(std::cos(half), s * omega.x(), s * omega.y(), s * omega.z()).normalized();
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;  // q and -q are the same rotation
  const Eigen::Vector3d v = sign * rotation.vec();
  const double w = sign * rotation.w();
  const double n = v.norm();
  if (n < kSmallAngle) return (2.0 / w) * (1.0 - n * n / (3.0 * w * w)) * v;
  return 2.0 * std::atan2(n, w) / n * v;
}

SE3 SE3::exp(const Vector6d& twist) {
  const Eigen::Vector3d omega = twist.tail<3>();
  return {exp_so3(omega), left_jacobian(omega) * twist.head<3>()};
}

Vector6d SE3::log() const {
  const Eigen::Vector3d omega = log_so3(rotation);
  Vector6d twist;
  twist << left_jacobian_inverse(omega) * translation, omega;
  return twist;
}

SE3 SE3::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
  return {inverse_rotation, -(inverse_rotation * translation)};
}

Eigen::Matrix4d SE3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = R();
  m.topRightCorner<3, 1>() = translation;
  return m;
}

Matrix6d SE3::adjoint() const {
  const Eigen::Matrix3d rotation_matrix = R();
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = rotation_matrix;
  ad.topRightCorner<3, 3>() = skew(translation) * rotation_matrix;
  ad.bottomRightCorner<3, 3>() = rotation_matrix;
  return ad;
}

SE3 operator*(const SE3& a, const SE3& b) {
  return {(a.rotation * b.rotation).normalized(), a.rotation * b.translation + a.translation};
}

Eigen::Vector3d operator*(const SE3& T, const Eigen::Vector3d& point) {
  return T.rotation * point + T.translation;
}

SE3 interpolate(const SE3& a, const SE3& b, double s) {
  return a * SE3::exp(s * (a.inverse() * b).log());
}

}  // namespace kinloop
