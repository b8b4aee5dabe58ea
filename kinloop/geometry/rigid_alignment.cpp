#include "kinloop/geometry/rigid_alignment.hpp"

#include <Eigen/SVD>

#include "kinloop/core/errors.hpp"

namespace kinloop {

std::optional<SE3> align_rigid(std::span<const Eigen::Vector3d> points_a,
                               std::span<const Eigen::Vector3d> points_b, std::span<const double> weights) {
  require(points_a.size() == points_b.size(), "align_rigid: point sets differ in size");
  require(weights.empty() || weights.size() == points_a.size(), "align_rigid: expected one weight per pair");
  if (points_a.size() < 3) return std::nullopt;

  const auto weight = [&](size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  double total = 0;
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero(), mean_b = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < points_a.size(); ++i) {
    total += weight(i);
    mean_a += weight(i) * points_a[i];
    mean_b += weight(i) * points_b[i];
  }
  if (!(total > 0)) return std::nullopt;
  mean_a /= total;
  mean_b /= total;

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < points_a.size(); ++i) {
    covariance += weight(i) * (points_a[i] - mean_a) * (points_b[i] - mean_b).transpose();
  }
  if (!covariance.allFinite()) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  constexpr double kRankTolerance = 1e-12;
  // Collinear points leave the rotation about their line free.
  if (svd.singularValues()(1) <= kRankTolerance * svd.singularValues()(0)) return std::nullopt;

  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return SE3{Eigen::Quaterniond(R).normalized(), mean_a - R * mean_b};
}

}  // namespace kinloop
