#include "kinloop/loop/verification/compare_visits.hpp"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "tests/loop/wall_view.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

/// Two visits of a wall that faces the camera, `wall_m` away, from places 0.5 m apart.
class TwoVisits : public testing::Test {
 protected:
  void visit(double wall_m, int different_views = 0) {
    const uint32_t component = map_.component_count();
    for (uint32_t i = 0; i < 6; ++i) {
      const SE3 T_world_camera = test::camera_at(0, {0.5 * i, 0, 0});
      Features features = *test::painted_wall_view(wall_m);
      if (i < static_cast<uint32_t>(different_views)) test::repaint(features);
      map_.add_keyframe(FrameId{10 * component + i}, 0, T_world_camera,
                        std::make_shared<const Features>(std::move(features)), component);
    }
  }

  /// Compares them if the first keyframes of both are at one place.
  [[nodiscard]] RoomComparison compare(const SE3& T_a_b = {}, int required_views = 0) const {
    return compare_rooms(problem(T_a_b, required_views)).rooms.at({KeyframeId{0}, KeyframeId{6}});
  }

  [[nodiscard]] JoinProblem problem(const SE3& T_a_b = {}, int required_views = 0) const {
    JoinProblem problem{.joins = {{{KeyframeId{0}, KeyframeId{6}, T_a_b}, required_views}},
                        .views = {},
                        .cache = {},
                        .sensor = sensor_};
    for (const Keyframe& keyframe : map_.keyframes()) problem.views.push_back(view_of(keyframe));
    return problem;
  }

  Map map_;
  const Sensor sensor_{PinholeCamera{640, 480, 525, 525, 319.5, 239.5, {}}};
};

TEST_F(TwoVisits, OfOneRoomAgree) {
  visit(2), visit(2);
  const RoomComparison same = compare();
  EXPECT_EQ(same.depths.free_space_violations, 0);
  EXPECT_GT(same.depths.consistent, 5000);
  EXPECT_EQ(same.appearance.views, 6);
  EXPECT_EQ(same.appearance.different_views, 0);
  EXPECT_FALSE(contradicts_same_room(same));
}

TEST_F(TwoVisits, OfAnotherFloorWithOtherPicturesLookDifferent) {
  visit(2), visit(2, 2);
  const RoomComparison floors = compare();
  EXPECT_EQ(floors.depths.free_space_violations, 0);
  EXPECT_EQ(floors.appearance.different_views, 2);
  EXPECT_TRUE(contradicts_same_room(floors));
}

TEST_F(TwoVisits, WhereOnePictureWasReplacedAreOfOneRoom) {
  visit(2), visit(2, 1);
  EXPECT_EQ(compare().appearance.different_views, 1);
  EXPECT_FALSE(contradicts_same_room(compare()));
}

TEST_F(TwoVisits, OfASmallerRoomSeeThroughItsWalls) {
  visit(2), visit(1.7);
  EXPECT_TRUE(contradicts_same_room(compare()));
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
  const RoomComparison none = compare(T_far);
  EXPECT_EQ(none.depths.consistent + none.depths.free_space_violations, 0);
  EXPECT_EQ(none.appearance.views, 0);
  EXPECT_FALSE(contradicts_same_room(none));
}

TEST_F(TwoVisits, DriftExplainsMoreFartherFromTheLoop) {
  visit(2), visit(2.05);
  MapUpdate stretched;  // the second visit seems to lead 12 m along the wall
  stretched.epoch = map_.epoch();
  for (uint32_t i = 0; i < 12; ++i)
    stretched.T_world_camera.emplace_back(KeyframeId{i}, test::camera_at(0, {2.4 * (i % 6), 0, 0}));
  const DepthConsistency near = compare().depths;
  ASSERT_TRUE(map_.apply(stretched));
  const DepthConsistency far = compare().depths;
  EXPECT_LT(far.free_space_violations, near.free_space_violations);
}

TEST_F(TwoVisits, AreNotComparedIfTooFewViewsOverlap) {
  visit(2), visit(2);
  EXPECT_EQ(compare({}, 6).appearance.views, 6);
  EXPECT_EQ(compare({}, 7).appearance.views, 0);
}

TEST_F(TwoVisits, ArePairsOfViewsThatAreComparedOnce) {
  visit(2), visit(2);
  const LoopEnds ends{KeyframeId{0}, KeyframeId{6}};
  JoinProblem repainted = problem();
  repainted.cache = compare_rooms(repainted).cache;
  for (KeyframeView& view : repainted.views) {
    if (view.component == 0) continue;
    Features features = *view.features;
    test::repaint(features);
    view.features = std::make_shared<const Features>(std::move(features));
  }
  const auto different_views = [&] {
    return compare_rooms(repainted).rooms.at(ends).appearance.different_views;
  };
  EXPECT_EQ(different_views(), 0) << "as it was known";
  repainted.joins[0].loop.T_a_b.translation.x() = 0.03;
  EXPECT_EQ(different_views(), 0) << "alignment leads to the same pose";
  repainted.joins[0].loop.T_a_b.translation.x() = 0.06;
  EXPECT_GT(different_views(), 0) << "drift does not explain that at the loop itself";
}

}  // namespace
}  // namespace kinloop
