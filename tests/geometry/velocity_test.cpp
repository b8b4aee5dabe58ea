#include "kinloop/geometry/velocity.hpp"

#include <gtest/gtest.h>

namespace kinloop {
namespace {

const SE3 kBefore{exp_so3({0.3, -0.8, 0.2}), {1, -2, 0.5}};
const SE3 kAfter{exp_so3({0.5, -0.6, 0.1}), {1.2, -1.9, 0.4}};

TEST(Velocity, AsAVectorIsLinearThenAngular) {
  const Velocity velocity{{1, 2, 3}, {4, 5, 6}};
  Vector6d expected;
  expected << 1, 2, 3, 4, 5, 6;
  EXPECT_EQ(velocity.vector(), expected);
  EXPECT_EQ(Velocity::from_vector(expected).linear_m_s, velocity.linear_m_s);
  EXPECT_EQ(Velocity::from_vector(expected).angular_rad_s, velocity.angular_rad_s);
  EXPECT_TRUE(Velocity{}.vector().isZero(0));
}

TEST(Velocity, BetweenPosesLeadsFromOneToTheOther) {
  const SE3 arrived = propagate_pose(kBefore, velocity_between(kBefore, kAfter, 0.3), 0.3);
  EXPECT_LT((arrived.inverse() * kAfter).log().norm(), 1e-12);
  EXPECT_THROW(velocity_between(kBefore, kAfter, 0), std::logic_error);
}

TEST(Velocity, BothDefinitionsAreTheInstantaneousOne) {
  // Over a short step the motion at constant twist and the one at constant linear velocity are the same.
  Vector6d twist;
  twist << 0.4, -0.2, 0.3, 0.9, -0.5, 0.7;
  const Velocity velocity = velocity_of_twist(twist, 2);
  EXPECT_EQ(velocity.vector(), twist / 2);
  constexpr double kStep_s = 1e-5;
  const SE3 after = kBefore * SE3::exp(twist / 2 * kStep_s);
  EXPECT_LT((velocity_between(kBefore, after, kStep_s).vector() - velocity.vector()).norm(), 1e-5);
}

TEST(Velocity, PointsAreSeenWhereTheLaterCameraIs) {
  const Velocity velocity{{0.3, -0.1, 0.2}, {0.5, 1.1, -0.4}};
  const Eigen::Vector3d p(0.2, -0.3, 1.5);
  constexpr double kLater_s = 0.04;
  const Eigen::Vector3d expected = propagate_pose(kBefore, velocity, kLater_s).inverse() * (kBefore * p);
  const Eigen::Vector3d later = point_in_later_camera(p, velocity, kLater_s);
  EXPECT_LT((later - expected).norm(), 1e-12);
  EXPECT_LT((point_in_earlier_camera(later, velocity, kLater_s) - p).norm(), 1e-12);
}

}  // namespace
}  // namespace kinloop
