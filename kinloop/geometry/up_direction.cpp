#include "kinloop/geometry/up_direction.hpp"

#include <Eigen/Eigenvalues>

namespace kinloop {

Eigen::Vector3d up_direction(const Trajectory& trajectory) {
  Eigen::Matrix3d rows = Eigen::Matrix3d::Zero();
  Eigen::Vector3d camera_up = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : trajectory) {
    const Eigen::Matrix3d R = pose.T_world_camera.R();
    rows += R.col(0) * R.col(0).transpose();
    camera_up -= R.col(1);
  }
  if (camera_up.norm() == 0) return Eigen::Vector3d::UnitZ();
  camera_up.normalize();
  // A camera that hardly turned leaves the tilt open; a little trust in its own up decides that.
  constexpr double kTrust = 0.02;
  rows -= kTrust * static_cast<double>(trajectory.size()) * camera_up * camera_up.transpose();
  const Eigen::Vector3d up = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rows).eigenvectors().col(0);
  return up.dot(camera_up) < 0 ? Eigen::Vector3d(-up) : up;
}

}  // namespace kinloop
