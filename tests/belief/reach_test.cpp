#include "kinloop/belief/reach.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

/// A camera last seen 2 m along x, which moves at 1 m/s along its own x axis.
class Reach : public testing::Test {
 protected:
  Reach() {
    map_.add_keyframe(FrameId{0}, 0, {{1, 0, 0, 0}, {1, 0, 0}}, std::make_shared<const Features>(), 0);
  }

  [[nodiscard]] bool can_reach(double x_m, double after_s, double drift_m = 0) const {
    const CameraMotion from{{KeyframeId{0}, {{1, 0, 0, 0}, {1, 0, 0}}}, {{1, 0, 0}, {0, 0, 0}}, to_ns(10)};
    return kinloop::can_reach(from, map_, {x_m, 0, 0}, to_ns(10 + after_s), drift_m);
  }

  Map map_;
};

TEST_F(Reach, AtOnceOnlyWhereItWas) {
  EXPECT_TRUE(can_reach(2, 0));
  EXPECT_TRUE(can_reach(2.4, 0)) << "drift";
  EXPECT_FALSE(can_reach(2.6, 0));
}

TEST_F(Reach, GoesOnWithItsVelocity) {
  EXPECT_TRUE(can_reach(4, 2));
  EXPECT_TRUE(can_reach(6, 2)) << "accelerates";
  EXPECT_FALSE(can_reach(7, 2));
}

TEST_F(Reach, StopsOrTurnsBack) {
  EXPECT_TRUE(can_reach(2, 1)) << "stops at once";
  EXPECT_FALSE(can_reach(1, 1));
  EXPECT_TRUE(can_reach(1, 3)) << "turns back";
  EXPECT_FALSE(can_reach(-1, 3));
}

TEST_F(Reach, ReachesFartherWhereTheMapMayHaveDrifted) {
  EXPECT_FALSE(can_reach(7, 2));
  EXPECT_TRUE(can_reach(7, 2, 1));
}

TEST_F(Reach, GrowsNoFasterThanPeopleRun) {
  EXPECT_TRUE(can_reach(12 - 30, 10));
  EXPECT_FALSE(can_reach(12 - 31, 10));
}

}  // namespace
}  // namespace kinloop
