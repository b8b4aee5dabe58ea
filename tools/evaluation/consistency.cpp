#include "tools/evaluation/consistency.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace kinloop {
namespace {

constexpr int64_t kMaxTruthGapNs = 100'000'000;

/// nullopt if the covariance is singular.
std::optional<double> normalised_squared(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  if (!covariance.allFinite() || factor.info() != Eigen::Success) return std::nullopt;
  return error.dot(factor.solve(error));
}

bool is_within_4_sigma(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
  return error.squaredNorm() <= 16 * eigen.eigenvalues().maxCoeff();
}

}  // namespace

Trajectory trajectory_of(std::span<const PoseWithCovariance> poses) {
  Trajectory trajectory;
  for (const PoseWithCovariance& pose : poses) trajectory.push_back({pose.stamp_ns, pose.T_world_camera});
  return trajectory;
}

std::optional<Consistency> evaluate_consistency(const std::vector<PoseWithCovariance>& poses,
                                                const Trajectory& truth) {
  if (poses.empty()) return std::nullopt;
  const auto T_truth_first = pose_at(truth, poses[0].stamp_ns, kMaxTruthGapNs);
  if (!T_truth_first) return std::nullopt;
  const SE3 T_world_truth = poses[0].T_world_camera * T_truth_first->inverse();
  Consistency sum;
  for (size_t i = 1; i < poses.size(); ++i) {
    const auto T_truth_camera = pose_at(truth, poses[i].stamp_ns, kMaxTruthGapNs);
    if (!T_truth_camera) continue;
    const Vector6d error = (poses[i].T_world_camera.inverse() * T_world_truth * *T_truth_camera).log();
    const Eigen::Matrix3d of_translation = poses[i].covariance.topLeftCorner<3, 3>();
    const Eigen::Matrix3d of_rotation = poses[i].covariance.bottomRightCorner<3, 3>();
    const auto translation = normalised_squared(error.head<3>(), of_translation);
    const auto rotation = normalised_squared(error.tail<3>(), of_rotation);
    if (!translation || !rotation) continue;
    ++sum.poses;
    sum.nees_translation += *translation;
    sum.nees_rotation += *rotation;
    const bool within =
        is_within_4_sigma(error.head<3>(), of_translation) && is_within_4_sigma(error.tail<3>(), of_rotation);
    sum.within_4_sigma += within ? 1 : 0;
  }
  if (sum.poses == 0) return std::nullopt;
  const auto count = static_cast<double>(sum.poses);
  return Consistency{sum.poses, sum.nees_translation / count, sum.nees_rotation / count,
                     sum.within_4_sigma / count};
}

}  // namespace kinloop
