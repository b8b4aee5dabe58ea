#include "kinloop/geometry/camera.hpp"

#include <Eigen/LU>

namespace kinloop {
namespace {

/// Distorted normalised coordinates and their 2x2 Jacobian with respect to the undistorted ones.
struct Distortion {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

Distortion distort_normalized(const PinholeCamera& c, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double slope = 2 * (c.k1 + r2 * (2 * c.k2 + 3 * r2 * c.k3));  // (d radial / d r2) * 2
  Distortion d;
  d.point = {x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
             y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
  d.jacobian << radial + x * x * slope + 2 * c.p1 * y + 6 * c.p2 * x,
      x * y * slope + 2 * c.p1 * x + 2 * c.p2 * y, x * y * slope + 2 * c.p1 * x + 2 * c.p2 * y,
      radial + y * y * slope + 6 * c.p1 * y + 2 * c.p2 * x;
  return d;
}

}  // namespace

Eigen::Matrix<double, 2, 3> PinholeCamera::project_jacobian(const Eigen::Vector3d& p) const {
  const double inv_z = 1.0 / p.z();
  Eigen::Matrix<double, 2, 3> J;
  J << fx * inv_z, 0, -fx * p.x() * inv_z * inv_z, 0, fy * inv_z, -fy * p.y() * inv_z * inv_z;
  return J;
}

Eigen::Vector2d PinholeCamera::distort(const Eigen::Vector2d& undistorted) const {
  if (!has_distortion()) return undistorted;
  const Eigen::Vector2d normalized((undistorted.x() - cx) / fx, (undistorted.y() - cy) / fy);
  const Eigen::Vector2d d = distort_normalized(*this, normalized).point;
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Eigen::Vector2d PinholeCamera::undistort(const Eigen::Vector2d& raw) const {
  if (!has_distortion()) return raw;
  const Eigen::Vector2d target((raw.x() - cx) / fx, (raw.y() - cy) / fy);
  constexpr int kMaxIterations = 20;
  constexpr double kConverged = 1e-10;
  Eigen::Vector2d p = target;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Distortion d = distort_normalized(*this, p);
    const Eigen::Vector2d step = d.jacobian.inverse() * (target - d.point);
    if (!step.allFinite()) return raw;
    p += step;
    if (step.squaredNorm() < kConverged * kConverged) break;
  }
  return {fx * p.x() + cx, fy * p.y() + cy};
}

}  // namespace kinloop
