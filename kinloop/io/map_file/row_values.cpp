#include "kinloop/io/map_file/row_values.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "kinloop/core/time.hpp"

namespace kinloop {

uint32_t take_index(RowReader& row, int64_t limit) {
  return static_cast<uint32_t>(row.take_in<int64_t>(0, limit - 1));
}

KeyframeId take_keyframe(RowReader& row) {
  return KeyframeId{static_cast<uint32_t>(row.take_in<int64_t>(0, KeyframeId::kNone))};
}

int64_t take_stamp(RowReader& row) {
  return row.take_in(-kMaxStampNs, kMaxStampNs);
}

SE3 take_pose(RowReader& row) {
  constexpr double kTolerance = 1e-3;
  SE3 pose;
  for (int i = 0; i < 3; ++i) pose.translation(i) = row.take_in(-kMaxDistanceM, kMaxDistanceM);
  for (int i = 0; i < 4; ++i) pose.rotation.coeffs()(i) = row.take<double>();
  if (!(std::abs(pose.rotation.norm() - 1) < kTolerance)) row.reject();
  return pose;
}

bool is_information(const Matrix6d& matrix) {
  constexpr double kMost = 1e15, kTolerance = 1e-6;
  const double largest = matrix.cwiseAbs().maxCoeff();
  if (!matrix.allFinite() || largest > kMost) return false;
  if ((matrix - matrix.transpose()).cwiseAbs().maxCoeff() > kTolerance * largest) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(matrix, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() >= -kTolerance * largest;
}

}  // namespace kinloop
