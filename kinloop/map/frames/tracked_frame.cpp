#include "kinloop/map/frames/tracked_frame.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace kinloop {

TrackedFrame unlocated(const Frame& frame) {
  TrackedFrame tracked;
  tracked.id = frame.id;
  tracked.stamp_ns = frame.stamp_ns;
  tracked.depth_stamp_difference_s = frame.features->depth_stamp_difference_s;
  return tracked;
}

void lose(EstimatedFrame& frame) {
  frame.outcome = TrackingOutcome::kLost;
  frame.matches.clear();
}

TrackedFrame without_pose(TrackedFrame tracked) {
  tracked.outcome = TrackingOutcome::kLost;
  tracked.method = TrackingMethod::kKeypoints;
  tracked.covariance.setZero();
  tracked.matches.clear();
  TrackingEvidence& evidence = tracked.evidence;
  evidence.visible_landmarks = evidence.inliers = evidence.with_depth = evidence.attempts = 0;
  return tracked;
}

std::vector<LandmarkId> landmark_of_keypoint(const TrackedFrame& tracked) {
  std::vector<LandmarkId> landmark_of(tracked.features().size());
  for (const auto& [landmark, feature] : tracked.matches) landmark_of[feature] = landmark;
  return landmark_of;
}

double position_sigma_m(const Matrix6d& covariance) {
  const Eigen::Matrix3d covariance_m2 = covariance.topLeftCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance_m2, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(eigen.eigenvalues().maxCoeff(), 0.0));
}

Matrix6d covariance_from_information(const Matrix6d& information) {
  constexpr double kUnknownVariance = 1e6;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  const Vector6d variances = eigen.eigenvalues().unaryExpr(
      [](double value) { return value > 1 / kUnknownVariance ? 1 / value : kUnknownVariance; });
  return eigen.eigenvectors() * variances.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace kinloop
