#include "kinloop/geometry/up_direction.hpp"

#include <gtest/gtest.h>

#include "kinloop/base/random.hpp"

namespace kinloop {
namespace {

/// A camera in a world with z up, turned by `yaw`, looking down by `pitch`, held askew by `roll`.
StampedPose held(double yaw, double pitch, double roll) {
  Eigen::Matrix3d level;  // looks along world y
  level << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const SE3 T_world_level{Eigen::Quaterniond(level), {}};
  const SE3 turn{exp_so3({0, 0, yaw}), {}};
  const SE3 tilt{exp_so3({-pitch, 0, 0}), {}};
  const SE3 skew{exp_so3({0, 0, roll}), {}};
  return {0, turn * T_world_level * tilt * skew};
}

TEST(UpDirection, OfACameraThatLooksDownAndAroundIsUp) {
  Random random(1);
  Trajectory path;
  for (int i = 0; i < 200; ++i) path.push_back(held(0.01 * i, 0.6, 0.05 * random.gaussian()));
  EXPECT_GT(up_direction(path).z(), 0.999);
}

TEST(UpDirection, OfACameraThatDoesNotTurnIsItsOwn) {
  const Trajectory path(10, held(0, 0.3, 0));
  EXPECT_LT((up_direction(path) + path.front().T_world_camera.R().col(1)).norm(), 1e-6);
}

TEST(UpDirection, OfNothingIsZ) {
  EXPECT_EQ(up_direction({}), Eigen::Vector3d::UnitZ());
}

}  // namespace
}  // namespace kinloop
