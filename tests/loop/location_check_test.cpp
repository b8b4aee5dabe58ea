#include "kinloop/loop/verification/location_check.hpp"

#include <gtest/gtest.h>

#include "tests/loop/wall_view.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

constexpr LocationEvidence kAgrees{{1, 0.003}, {500, 0}, 1};

LocationCheck after(int frames, const LocationEvidence& evidence, bool confident = true) {
  LocationCheck check;
  for (int i = 0; i < frames; ++i) check.add(evidence, confident);
  return check;
}

TEST(LocationCheck, TwoFramesThatAgreeConfirmAPlace) {
  EXPECT_FALSE(after(1, kAgrees).is_confirmed());
  EXPECT_TRUE(after(2, kAgrees).is_confirmed());
  EXPECT_FALSE(after(2, kAgrees).is_contradicted());
}

TEST(LocationCheck, APlaceOfAnotherSizeIsRefuted) {
  EXPECT_TRUE(after(1, {{1.04, 0.003}, {500, 0}, 1}).is_contradicted());
  EXPECT_TRUE(after(1, {{0.96, 0.003}, {500, 0}, 1}).is_contradicted());
  EXPECT_FALSE(after(1, {{1.01, 0.003}, {500, 0}, 1}).is_contradicted());
}

TEST(LocationCheck, TheScalesOfSeveralFramesTellMoreThanThatOfOne) {
  const LocationEvidence vague{{1.04, 0.02}, {500, 0}, 1};
  EXPECT_FALSE(after(1, vague).is_contradicted());
  EXPECT_TRUE(after(9, vague).is_contradicted());
}

TEST(LocationCheck, KeypointsInFreeSpaceRefuteAPlaceThatHadBeenConfirmed) {
  LocationCheck check = after(5, kAgrees);
  const LocationEvidence contradicts{{1, 0.003}, {400, 100}, 1};
  check.add(contradicts, true);
  EXPECT_TRUE(check.is_contradicted());
}

TEST(LocationCheck, OldFramesDoNotOutweighTheLatest) {
  LocationCheck check = after(1000, kAgrees);
  for (int i = 0; i < 5; ++i) check.add({{1, 0.003}, {460, 40}, 1}, true);
  EXPECT_TRUE(check.is_contradicted());
}

TEST(LocationCheck, APlaceThatLooksDifferentInMostFramesIsRefuted) {
  const LocationEvidence different{{1, 0.003}, {500, 0}, 1e-4};
  EXPECT_TRUE(after(1, different).is_contradicted());
  LocationCheck check = after(1, kAgrees);
  check.add(different, true);
  EXPECT_FALSE(check.is_contradicted());
  check.add(different, true);
  EXPECT_TRUE(check.is_contradicted());
}

TEST(LocationCheck, AConfirmedPlaceIsRefutedWhereTooManyFramesLookDifferent) {
  LocationCheck check;
  for (int i = 0; i < 2; ++i) check.add({{}, {200, 0}}, true);
  ASSERT_TRUE(check.is_confirmed());
  for (int i = 0; i < 9; ++i) check.add_appearance(0.5);
  for (int i = 0; i < 3; ++i) check.add_appearance(1e-6);
  EXPECT_FALSE(check.is_contradicted()) << "a quarter: something was moved";
  check.add_appearance(1e-6);
  EXPECT_TRUE(check.is_contradicted());
}

TEST(LocationCheck, AFewDifferentFramesSayNothing) {
  LocationCheck check;
  for (int i = 0; i < 3; ++i) check.add_appearance(1e-6);
  EXPECT_FALSE(check.is_contradicted());
}

TEST(LocationCheck, WithoutDepthTenConfidentFramesConfirmAPlace) {
  EXPECT_FALSE(after(9, {}).is_confirmed());
  EXPECT_TRUE(after(10, {}).is_confirmed());
  EXPECT_FALSE(after(100, {}, false).is_confirmed());
}

/// Keyframes that face a wall 2 m away.
class CompareWithViews : public testing::Test {
 protected:
  CompareWithViews() {
    for (uint32_t i = 0; i < 6; ++i)
      map_.add_keyframe(FrameId{i}, 0, test::camera_at(0, {0.1 * i, 0, 0}), test::wall_view(2), 0);
  }

  [[nodiscard]] LocationEvidence compare(double wall_m,
                                         const SE3& T_world_camera = test::camera_at(0, {0, 0, 0}),
                                         uint32_t component = 0, uint32_t end = 6) const {
    return compare_with_views(map_, KeyframeId{end}, {component, T_world_camera, *test::wall_view(wall_m)},
                              sensor_);
  }

  Map map_;
  const Sensor sensor_{PinholeCamera{640, 480, 525, 525, 319.5, 239.5, {}}};
};

TEST_F(CompareWithViews, TheSameWallAgreesAndANearerOneIsInFreeSpace) {
  const DepthConsistency same = compare(2).depths, nearer = compare(1.7).depths;
  EXPECT_GT(same.consistent, 5000);
  EXPECT_EQ(same.free_space_violations, 0);
  EXPECT_GT(nearer.free_space_violations, 5000);
}

TEST_F(CompareWithViews, APictureThatHangsElsewhereLooksDifferent) {
  Features other = *test::wall_view(2);
  other.descriptors.rowRange(0, other.descriptors.rows / 4) = 255;
  const auto evidence_of = [&](const Features& features) {
    return compare_with_views(map_, KeyframeId{6}, {0, test::camera_at(0, {0, 0, 0}), features}, sensor_);
  };
  EXPECT_LT(evidence_of(other).appearance_p_value, 1e-4);
  EXPECT_GT(evidence_of(*test::wall_view(2)).appearance_p_value, 0.5);
}

TEST_F(CompareWithViews, OtherViewsSayNothing) {
  EXPECT_EQ(compare(1.7, test::camera_at(0, {0, 0, 0}), 1).depths.free_space_violations, 0)
      << "another component";
  EXPECT_EQ(compare(1.7, test::camera_at(0, {0, 0, 0}), 0, 0).depths.free_space_violations, 0)
      << "made later";
  EXPECT_EQ(compare(1.7, test::camera_at(0, {5, 0, 0})).depths.free_space_violations, 0) << "far away";
  EXPECT_EQ(compare(1.7, test::camera_at(1, {0, 0, 0})).depths.free_space_violations, 0)
      << "another direction";
}

TEST_F(CompareWithViews, WithdrawnKeyframesSayNothing) {
  for (uint32_t i = 0; i < 6; ++i) map_.withdraw(KeyframeId{i});
  EXPECT_EQ(compare(1.7).depths.free_space_violations, 0);
}

}  // namespace
}  // namespace kinloop
