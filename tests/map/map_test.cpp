#include "kinloop/map/map.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

std::shared_ptr<const Features> blank_features(size_t count) {
  Features features;
  features.pixels.assign(count, Eigen::Vector2f::Zero());
  return std::make_shared<const Features>(features);
}

KeyframeId add_keyframe(Map& map, const SE3& T_world_camera = {}) {
  const auto number = static_cast<uint32_t>(map.keyframes().size());
  return map.add_keyframe(FrameId{number}, number * 1000, T_world_camera, blank_features(30));
}

LoopClosure verified(KeyframeId a, KeyframeId b, const SE3& T_a_b) {
  return {a, b, T_a_b, Matrix6d::Identity(), {50}, LoopStage::kVerified};
}

TEST(Map, ObservationsHaveTwoSides) {
  Map map;
  const KeyframeId a = add_keyframe(map), b = add_keyframe(map);
  const LandmarkId landmark = map.add_landmark(a, 3, {0, 0, 1});
  EXPECT_TRUE(map.add_observation(landmark, {b, 7}));
  EXPECT_EQ(map.keyframe(b).landmark_of[7], landmark);
  EXPECT_EQ(map.landmark(landmark).observations.size(), 2U);
  EXPECT_FALSE(map.add_observation(landmark, {b, 8}));  // b already observes it
  const LandmarkId other = map.add_landmark(a, 4, {0, 0, 1});
  EXPECT_FALSE(map.add_observation(other, {b, 7}));  // the keypoint is already used
  map.check_invariants();
}

TEST(Map, ALandmarkFollowsItsAnchor) {
  Map map;
  const KeyframeId a = add_keyframe(map);
  const LandmarkId landmark = map.add_landmark(a, 0, {0, 0, 2});
  MapUpdate update;
  update.T_world_camera = {{a, test::camera_at(1.0, {1, 2, 3})}};
  update.newest_keyframe = a;
  ASSERT_TRUE(map.apply(update));
  EXPECT_LT((map.p_world(landmark) - test::camera_at(1.0, {1, 2, 3}) * Eigen::Vector3d(0, 0, 2)).norm(),
            1e-12);
}

TEST(Map, AWithdrawnKeyframeObservesNothingAndBelongsToNoOther) {
  Map map;
  const KeyframeId a = add_keyframe(map), b = add_keyframe(map), c = add_keyframe(map);
  const LandmarkId shared = map.add_landmark(b, 0, {0, 0, 2}), own = map.add_landmark(b, 1, {0, 0, 3});
  map.add_observation(shared, {c, 5});
  map.add_loop_closure(verified(a, b, SE3{}));
  map.add_loop_closure(verified(a, c, SE3{}));
  const uint32_t epoch = map.epoch();
  map.withdraw(b);
  EXPECT_FALSE(map.contains(own));
  ASSERT_TRUE(map.contains(shared));
  EXPECT_EQ(map.landmark(shared).anchor, c);
  EXPECT_NE(map.keyframe(b).component, map.keyframe(a).component);
  EXPECT_TRUE(map.keyframe(b).begins_component && map.keyframe(b).withdrawn);
  EXPECT_THROW(map.add_loop_closure(verified(a, b, SE3{})), std::logic_error);
  EXPECT_EQ(map.component_count(), 2U);
  ASSERT_EQ(map.loop_closures().size(), 1U);
  EXPECT_EQ(map.loop_closures()[0].b, c);
  EXPECT_GT(map.epoch(), epoch);  // jobs in flight still use it
  map.check_invariants();
}

TEST(Map, RemovingTheAnchorObservationKeepsTheWorldPoint) {
  Map map;
  const KeyframeId a = add_keyframe(map, test::camera_at(0.3, {1, 0, 0}));
  const KeyframeId b = add_keyframe(map, test::camera_at(-0.2, {0, 1, 0}));
  const LandmarkId landmark = map.add_landmark(a, 0, {0.1, 0.2, 2});
  map.add_observation(landmark, {b, 5});
  const Eigen::Vector3d before = map.p_world(landmark);
  map.remove_observation(landmark, {a, 0});
  EXPECT_EQ(map.landmark(landmark).anchor, b);
  EXPECT_LT((map.p_world(landmark) - before).norm(), 1e-12);
  map.remove_observation(landmark, {b, 5});
  EXPECT_FALSE(map.contains(landmark));
  map.check_invariants();
}

TEST(Map, NewerKeyframesFollowCorrectionsRigidly) {
  Map map;
  const KeyframeId a = add_keyframe(map);
  const KeyframeId b = add_keyframe(map, test::camera_at(0.1, {1, 0, 0}));
  const KeyframeId c = add_keyframe(map, test::camera_at(0.2, {2, 0, 0}));
  const SE3 T_b_c = map.keyframe(b).T_world_camera.inverse() * map.keyframe(c).T_world_camera;
  MapUpdate update;
  update.T_world_camera = {{a, SE3{}}, {b, test::camera_at(0.5, {1, 1, 0})}};
  update.newest_keyframe = b;
  ASSERT_TRUE(map.apply(update));
  const SE3 T_b_c_after = map.keyframe(b).T_world_camera.inverse() * map.keyframe(c).T_world_camera;
  EXPECT_LT((T_b_c.inverse() * T_b_c_after).log().norm(), 1e-12);
}

TEST(Map, ALoopClosureMergesComponents) {
  Map map;
  const KeyframeId a = add_keyframe(map, test::camera_at(0.3, {1, 2, 0}));
  const KeyframeId b = map.add_keyframe(FrameId{1}, 1000, SE3{}, blank_features(30), map.component_count());
  const KeyframeId c =
      map.add_keyframe(FrameId{2}, 2000, test::camera_at(0.1, {0, 0, 1}), blank_features(30), 1);
  const LandmarkId landmark = map.add_landmark(c, 0, {0.1, 0.2, 2});
  const SE3 T_b_c = map.keyframe(b).T_world_camera.inverse() * map.keyframe(c).T_world_camera;
  EXPECT_EQ(map.component_count(), 2U);
  EXPECT_TRUE(map.keyframe(b).begins_component);
  EXPECT_FALSE(map.keyframe(c).begins_component);

  MapUpdate of_two_components;
  of_two_components.epoch = map.epoch();
  const SE3 T_a_c = test::camera_at(-0.2, {0.3, 0, 0.1});
  map.add_loop_closure(verified(a, c, T_a_c));
  EXPECT_EQ(map.keyframe(b).component, 0U);
  EXPECT_EQ(map.keyframe(c).component, 0U);
  const SE3& T_world_a = map.keyframe(a).T_world_camera;
  const SE3& T_world_c = map.keyframe(c).T_world_camera;
  EXPECT_LT((T_world_a.inverse() * test::camera_at(0.3, {1, 2, 0})).log().norm(), 1e-12);  // the older stays
  EXPECT_LT(((T_world_a * T_a_c).inverse() * T_world_c).log().norm(), 1e-12);
  EXPECT_LT(((map.keyframe(b).T_world_camera * T_b_c).inverse() * T_world_c).log().norm(), 1e-12);
  EXPECT_LT((map.p_world(landmark) - T_world_c * Eigen::Vector3d(0.1, 0.2, 2)).norm(), 1e-12);
  EXPECT_FALSE(map.apply(of_two_components));
  map.check_invariants();
}

TEST(Map, ALoopClosureMayNameTheYoungerComponentFirst) {
  Map map;
  const KeyframeId a = add_keyframe(map, test::camera_at(0.3, {1, 2, 0}));
  const KeyframeId b = map.add_keyframe(FrameId{1}, 1000, SE3{}, blank_features(30), 1);
  const SE3 T_b_a = test::camera_at(-0.2, {0.3, 0, 0.1});
  map.add_loop_closure(verified(b, a, T_b_a));
  EXPECT_LT((map.keyframe(a).T_world_camera.inverse() * test::camera_at(0.3, {1, 2, 0})).log().norm(), 1e-12);
  const SE3 T_b_a_after = map.keyframe(b).T_world_camera.inverse() * map.keyframe(a).T_world_camera;
  EXPECT_LT((T_b_a.inverse() * T_b_a_after).log().norm(), 1e-12);
}

TEST(Map, OnlyAVerifiedLoopClosureIsAccepted) {
  Map map;
  const KeyframeId a = add_keyframe(map), b = add_keyframe(map);
  LoopClosure loop = verified(a, b, SE3{});
  for (const auto stage : {LoopStage::kHypothesis, LoopStage::kProvisional, LoopStage::kAccepted,
                           LoopStage::kRejected, LoopStage::kWithdrawn}) {
    loop.stage = stage;
    EXPECT_THROW(map.add_loop_closure(loop), std::logic_error);
  }
  EXPECT_TRUE(map.loop_closures().empty());
  map.add_loop_closure(verified(a, b, SE3{}));
  ASSERT_EQ(map.loop_closures().size(), 1U);
  EXPECT_EQ(map.loop_closures()[0].stage, LoopStage::kAccepted);
  MapData data = map.data();
  data.loop_closures[0].stage = LoopStage::kWithdrawn;
  EXPECT_THROW(Map().append(std::move(data)), std::logic_error);
}

TEST(Map, KeyframesFollowTheNewestOfTheirOwnComponent) {
  Map map;
  const KeyframeId a = add_keyframe(map);
  const KeyframeId b = map.add_keyframe(FrameId{1}, 1000, SE3{}, blank_features(30), 1);
  MapUpdate update;
  update.T_world_camera = {{a, test::camera_at(0, {1, 0, 0})}, {b, test::camera_at(0, {0, 5, 0})}};
  update.newest_keyframe = b;
  const KeyframeId c = add_keyframe(map, test::camera_at(0, {0, 0, 1}));  // of the component of a
  const KeyframeId d = map.add_keyframe(FrameId{3}, 3000, SE3{}, blank_features(30), 2);
  ASSERT_TRUE(map.apply(update));
  EXPECT_LT((map.keyframe(c).T_world_camera.translation - Eigen::Vector3d(1, 0, 1)).norm(), 1e-12);
  EXPECT_LT(map.keyframe(d).T_world_camera.translation.norm(), 1e-12);
}

TEST(Map, AStaleUpdateIsDropped) {
  Map map;
  const KeyframeId a = add_keyframe(map);
  MapUpdate update;
  update.T_world_camera = {{a, test::camera_at(0, {9, 9, 9})}};
  update.newest_keyframe = a;
  update.epoch = map.epoch();
  map.advance_epoch();
  EXPECT_FALSE(map.apply(update));
  EXPECT_EQ(map.keyframe(a).T_world_camera.translation, Eigen::Vector3d(0, 0, 0));
}

TEST(Map, UpdatesSkipErasedLandmarks) {
  Map map;
  const KeyframeId a = add_keyframe(map), b = add_keyframe(map);
  const LandmarkId gone = map.add_landmark(a, 0, {0, 0, 1});
  const LandmarkId stays = map.add_landmark(a, 1, {0, 0, 1});
  map.add_observation(gone, {b, 0});
  map.erase(gone);
  MapUpdate update;
  update.p_world = {{gone, {1, 1, 1}}, {stays, {2, 2, 2}}};
  update.outliers = {{gone, {b, 0}}};
  update.merges = {{{a, b}, {{gone, stays}, {stays, gone}, {stays, stays}}}};
  update.newest_keyframe = b;
  ASSERT_TRUE(map.apply(update));
  EXPECT_LT((map.p_world(stays) - Eigen::Vector3d(2, 2, 2)).norm(), 1e-12);
  map.check_invariants();
}

TEST(Map, MergingMovesObservations) {
  Map map;
  const KeyframeId a = add_keyframe(map), b = add_keyframe(map), c = add_keyframe(map);
  const LandmarkId older = map.add_landmark(a, 0, {0, 0, 1});
  const LandmarkId newer = map.add_landmark(b, 0, {0, 0, 1});
  map.add_observation(newer, {c, 1});
  map.add_observation(older, {c, 2});  // c sees both: only one can stay
  map.merge(newer, older);
  EXPECT_FALSE(map.contains(newer));
  EXPECT_EQ(map.landmark(older).observations.size(), 3U);
  EXPECT_FALSE(map.keyframe(c).landmark_of[1].valid());
  map.check_invariants();
}

TEST(Map, CovisibleCountsSharedLandmarks) {
  Map map;
  const KeyframeId a = add_keyframe(map), b = add_keyframe(map), c = add_keyframe(map);
  for (uint32_t i = 0; i < 10; ++i) {
    const LandmarkId landmark = map.add_landmark(a, i, {0, 0, 1});
    if (i < 3) map.add_observation(landmark, {b, i});
    if (i < 6) map.add_observation(landmark, {c, i});
  }
  const std::vector<std::pair<KeyframeId, int>> expected{{c, 6}, {b, 3}};
  EXPECT_EQ(map.covisible_keyframes(a, 1), expected);
  EXPECT_EQ(map.covisible_keyframes(a, 4).size(), 1U);
}

TEST(Map, InvariantsHoldUnderRandomOperations) {
  Map map;
  Random random(5);
  for (int i = 0; i < 8; ++i) add_keyframe(map);
  const auto random_keyframe = [&] { return KeyframeId{random.index(8)}; };
  for (int step = 0; step < 4000; ++step) {
    const auto ids = map.landmark_ids();
    const auto random_landmark = [&] { return ids[random.index(static_cast<uint32_t>(ids.size()))]; };
    const uint32_t verb = random.index(10);
    const Observation seen{random_keyframe(), random.index(30)};
    if (ids.size() < 2 || verb < 3) {
      if (!map.keyframe(seen.keyframe).landmark_of[seen.feature].valid())
        map.add_landmark(seen.keyframe, seen.feature, {0, 0, 1});
    } else if (verb < 7) {
      map.add_observation(random_landmark(), seen);
    } else if (verb < 8) {
      const LandmarkId id = random_landmark();
      map.remove_observation(id, map.landmark(id).observations.front());
    } else if (verb < 9) {
      const LandmarkId goes = random_landmark(), stays = random_landmark();
      if (goes != stays) map.merge(goes, stays);
    } else {
      map.erase(random_landmark());
    }
    if (step % 50 == 0) map.check_invariants();
  }
  map.check_invariants();
}

TEST(Map, ViolatedPreconditionsThrowLogicError) {
  Map map;
  EXPECT_THROW((void)map.keyframe(KeyframeId{0}), std::logic_error);
  EXPECT_THROW((void)map.landmark(LandmarkId{0}), std::logic_error);
  const KeyframeId a = add_keyframe(map);
  EXPECT_THROW(map.add_landmark(a, 30, {0, 0, 1}), std::logic_error);
  EXPECT_THROW(map.add_landmark(a, 0, {0, 0, std::nan("")}), std::logic_error);
  EXPECT_THROW(map.add_loop_closure(verified(a, KeyframeId{7}, SE3{})), std::logic_error);
}

TEST(Map, FeaturesAreReplacedByTheSameKeypointsOnly) {
  Map map;
  const KeyframeId a = add_keyframe(map);
  const LandmarkId landmark = map.add_landmark(a, 3, {0, 0, 1});
  Features moved = *map.keyframe(a).features;
  moved.pixels[3] = {7, 8};
  map.set_features(a, std::make_shared<const Features>(moved));
  EXPECT_EQ(map.keyframe(a).features->pixels[3], Eigen::Vector2f(7, 8));
  EXPECT_EQ(map.keyframe(a).landmark_of[3], landmark);
  map.check_invariants();
  EXPECT_THROW(map.set_features(a, blank_features(29)), std::logic_error);
  EXPECT_THROW(map.set_features(a, nullptr), std::logic_error);
}

}  // namespace
}  // namespace kinloop
