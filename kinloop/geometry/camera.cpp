#include "kinloop/geometry/camera.hpp"

namespace kinloop {

Eigen::Matrix<double, 2, 3> PinholeCamera::project_jacobian(const Eigen::Vector3d& p) const {
  const double inv_z = 1.0 / p.z();
  Eigen::Matrix<double, 2, 3> J;
  J << fx * inv_z, 0, -fx * p.x() * inv_z * inv_z, 0, fy * inv_z, -fy * p.y() * inv_z * inv_z;
  return J;
}

Eigen::Vector2d PinholeCamera::distort(const Eigen::Vector2d& undistorted) const {
  if (!has_distortion()) return undistorted;
  const Eigen::Vector2d d = lens.distort({(undistorted.x() - cx) / fx, (undistorted.y() - cy) / fy});
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Eigen::Matrix2d PinholeCamera::distort_jacobian(const Eigen::Vector2d& undistorted) const {
  if (!has_distortion()) return Eigen::Matrix2d::Identity();
  Eigen::Matrix2d J = lens.distort_jacobian({(undistorted.x() - cx) / fx, (undistorted.y() - cy) / fy});
  J(0, 1) *= fx / fy;
  J(1, 0) *= fy / fx;
  return J;
}

Eigen::Vector2d PinholeCamera::undistort(const Eigen::Vector2d& raw) const {
  if (!has_distortion()) return raw;
  const Eigen::Vector2d p = lens.undistort({(raw.x() - cx) / fx, (raw.y() - cy) / fy});
  return {fx * p.x() + cx, fy * p.y() + cy};
}

std::optional<Eigen::Vector2d> undistort_in_view(const PinholeCamera& camera, const Eigen::Vector2d& raw) {
  constexpr double kSamePixel_px = 0.1;
  const Eigen::Vector2d undistorted = camera.undistort(raw);
  if (!((camera.distort(undistorted) - raw).norm() < kSamePixel_px)) return std::nullopt;
  return undistorted;
}

}  // namespace kinloop
