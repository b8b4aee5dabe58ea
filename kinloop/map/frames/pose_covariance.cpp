#include "kinloop/map/frames/pose_covariance.hpp"

namespace kinloop {

std::optional<Matrix6d> pose_covariance(const EstimatedFrame& tracked) {
  if (tracked.is_lost() || tracked.world_covariance.isZero(0)) return std::nullopt;
  return tracked.world_covariance;
}

std::array<double, 21> upper_triangle(const Matrix6d& symmetric) {
  std::array<double, 21> values{};
  size_t i = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) values[i++] = symmetric(row, column);
  }
  return values;
}

Matrix6d covariance_in_world_axes(const Matrix6d& covariance, const SE3& T_world_camera) {
  // T exp(x) = (R exp(w), t + R v) to first order in x = (v, w), and R exp(w) = exp(R w) R.
  Matrix6d to_world = Matrix6d::Zero();
  to_world.topLeftCorner<3, 3>() = to_world.bottomRightCorner<3, 3>() = T_world_camera.R();
  return to_world * covariance * to_world.transpose();
}

}  // namespace kinloop
