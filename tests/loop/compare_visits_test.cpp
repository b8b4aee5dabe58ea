#include "kinloop/loop/compare_visits.hpp"

#include <gtest/gtest.h>

#include "tests/loop/wall_view.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

/// Two visits of a wall that faces the camera, `wall_m` away, from places 0.5 m apart.
class TwoVisits : public testing::Test {
 protected:
  void visit(double wall_m) {
    const uint32_t component = map_.component_count();
    for (uint32_t i = 0; i < 6; ++i) {
      const SE3 T_world_camera = test::camera_at(0, {0.5 * i, 0, 0});
      map_.add_keyframe(FrameId{10 * component + i}, 0, T_world_camera, test::wall_view(wall_m), component);
    }
  }

  /// Compares them if the first keyframes of both are at one place.
  [[nodiscard]] DepthConsistency compare() const {
    return compare_components(map_, {KeyframeId{0}, KeyframeId{6}, SE3{}}, sensor_);
  }

  Map map_;
  const Sensor sensor_{PinholeCamera{640, 480, 525, 525, 319.5, 239.5, {}}};
};

TEST_F(TwoVisits, OfOneRoomAgree) {
  visit(2), visit(2);
  const DepthConsistency depths = compare();
  EXPECT_EQ(depths.free_space_violations, 0);
  EXPECT_GT(depths.consistent, 5000);
  EXPECT_FALSE(refutes_same_room(depths));
}

TEST_F(TwoVisits, OfASmallerRoomSeeThroughItsWalls) {
  visit(2), visit(1.7);
  EXPECT_TRUE(refutes_same_room(compare()));
}

TEST_F(TwoVisits, ViewsThatDoNotOverlapSayNothing) {
  visit(2), visit(1.7);
  MapUpdate away;
  away.epoch = map_.epoch();
  for (uint32_t i = 7; i < 12; ++i)
    away.T_world_camera.emplace_back(KeyframeId{i}, test::camera_at(1.5, {0, 0, 5.0 + i}));
  away.T_world_camera.emplace_back(KeyframeId{6}, test::camera_at(1.5, {0, 0, 20}));
  ASSERT_TRUE(map_.apply(away));
  const SE3 T_far = test::camera_at(3, {30, 0, 0});
  const DepthConsistency depths = compare_components(map_, {KeyframeId{0}, KeyframeId{6}, T_far}, sensor_);
  EXPECT_EQ(depths.consistent + depths.free_space_violations, 0);
  EXPECT_FALSE(refutes_same_room(depths));
}

TEST_F(TwoVisits, DriftExplainsMoreFartherFromTheLoop) {
  visit(2), visit(2.05);
  MapUpdate stretched;  // the second visit seems to lead 12 m along the wall
  stretched.epoch = map_.epoch();
  for (uint32_t i = 0; i < 12; ++i)
    stretched.T_world_camera.emplace_back(KeyframeId{i}, test::camera_at(0, {2.4 * (i % 6), 0, 0}));
  const DepthConsistency near = compare();
  ASSERT_TRUE(map_.apply(stretched));
  const DepthConsistency far = compare();
  EXPECT_LT(far.free_space_violations, near.free_space_violations);
}

}  // namespace
}  // namespace kinloop
