#include "kinloop/map/frames/pose_covariance.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

TEST(PoseCovariance, IsUnknownWithoutAPoseOrIfItIsZero) {
  TrackedFrame tracked;
  tracked.outcome = TrackingOutcome::kTracked;
  EXPECT_FALSE(pose_covariance(tracked));
  tracked.world_covariance = Matrix6d::Identity();
  EXPECT_EQ(pose_covariance(tracked), Matrix6d(Matrix6d::Identity()));
  tracked.outcome = TrackingOutcome::kLost;
  EXPECT_FALSE(pose_covariance(tracked));
}

TEST(PoseCovariance, UpperTriangleGoesRowByRow) {
  Matrix6d matrix;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column)
      matrix(row, column) = 10 * std::min(row, column) + std::max(row, column);
  }
  const auto upper = upper_triangle(matrix);
  EXPECT_EQ(upper[0], 0);
  EXPECT_EQ(upper[5], 5);
  EXPECT_EQ(upper[6], 11);
  EXPECT_EQ(upper[11], 22);
  EXPECT_EQ(upper[20], 55);
}

/// Of small motions x of the camera, the spread of position and of rotation about the axes of the world is
/// what the rotated covariance says.
TEST(PoseCovariance, InWorldAxesIsThatOfTheMovedPoses) {
  const SE3 T = test::camera_at(0.7, {3, -2, 1}) * SE3{exp_so3({0.4, -0.2, 0.9}), {0, 0, 0}};
  Matrix6d root = Matrix6d::Zero();
  for (int k = 0; k < 6; ++k) root(k, k) = 1e-4 * (k + 1);
  root(0, 4) = 2e-4;
  const Matrix6d covariance = root * root.transpose();
  Matrix6d moved = Matrix6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const SE3 T_moved = T * SE3::exp(root.col(k));
    Vector6d difference;
    difference << T_moved.translation - T.translation, log_so3(T_moved.rotation * T.rotation.conjugate());
    moved += difference * difference.transpose();
  }
  EXPECT_LT((covariance_in_world_axes(covariance, T) - moved).norm(), 1e-3 * covariance.norm());
  EXPECT_GT((covariance - moved).norm(), 0.1 * covariance.norm());
}

}  // namespace
}  // namespace kinloop
