#include <gtest/gtest.h>

#include "kinloop/mapping/grow.hpp"
#include "kinloop/mapping/local_adjustment.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::looking;

const test::SyntheticWorld& world() {
  static const test::SyntheticWorld kWorld = test::make_world(2500, 1);
  return kWorld;
}

/// True poses along a short arc.
SE3 true_pose(int i) {
  return looking(0.08 * i, {0.06 * i, 0.01 * (i % 3), -0.03 * i});
}

TEST(Grow, MakesLandmarksOfKeyPointsWithDepth) {
  const auto view = test::observe(world(), SE3{}, {0, 0, 0, 0.3}, 2);
  Map map;
  const KeyframeId id = map.add_keyframe(FrameId{0}, 0, SE3{}, view.features);
  MappingOptions options;
  options.max_depth_m = 1.9;
  const int grown = grow_from_depth(map, id, world().camera, options);
  EXPECT_EQ(static_cast<size_t>(grown), map.landmark_count());
  int expected = 0;
  for (uint32_t i = 0; i < view.point_of.size(); ++i) {
    const float depth_m = view.features->depths_m[i];
    const LandmarkId landmark = map.keyframe(id).landmark_of[i];
    EXPECT_EQ(landmark.valid(), depth_m > 0 && depth_m <= 1.9F);
    if (!landmark.valid()) continue;
    ++expected;
    EXPECT_LT((map.p_world(landmark) - world().p_world[view.point_of[i]]).norm(), 1e-3);
  }
  EXPECT_EQ(grown, expected);
  EXPECT_EQ(grow_from_depth(map, id, world().camera, options), 0);  // each key point only once
  map.check_invariants();
}

TEST(Grow, AttachesLandmarksSeenBefore) {
  test::SyntheticMap built;
  const auto first = test::observe(world(), SE3{}, {}, 2);
  test::add_view(built, world(), first, SE3{});
  const SE3 pose = true_pose(1);
  const auto second = test::observe(world(), pose, {}, 3);
  const KeyframeId id = built.map.add_keyframe(FrameId{1}, 1, pose, second.features);
  // The view must be centred on the new keyframe, which sees nothing yet: borrow the first one's landmarks.
  LocalView view = make_local_view(built.map, KeyframeId{0}, {});
  const SE3 T_new_first = pose.inverse();
  for (size_t i = 0; i < view.size(); ++i) {
    view.p_reference[i] = T_new_first * view.p_reference[i];
    view.viewed_from[i] = T_new_first.rotation * view.viewed_from[i];
  }
  EXPECT_GT(attach_landmarks(built.map, id, view, world().camera, {}), 80);
  int wrong = 0;
  for (uint32_t i = 0; i < second.point_of.size(); ++i) {
    const LandmarkId landmark = built.map.keyframe(id).landmark_of[i];
    wrong += landmark.valid() && landmark != built.landmark_of_point.at(second.point_of[i]) ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  built.map.check_invariants();
}

TEST(Grow, CullsWhatNobodyConfirms) {
  test::SyntheticMap built;
  for (int i = 0; i < 4; ++i) {
    test::add_view(built, world(), test::observe(world(), true_pose(i), {}, static_cast<uint64_t>(i)),
                   true_pose(i));
  }
  size_t lonely = 0;
  for (const LandmarkId id : built.map.landmark_ids()) {
    const Landmark& landmark = built.map.landmark(id);
    lonely += landmark.anchor == KeyframeId{0} && landmark.observations.size() < 2 ? 1 : 0;
  }
  const size_t before = built.map.landmark_count();
  ASSERT_GT(lonely, 0U);
  EXPECT_EQ(static_cast<size_t>(cull_landmarks(built.map, {})), lonely);
  EXPECT_EQ(built.map.landmark_count(), before - lonely);
  built.map.check_invariants();
}

/// Keyframes along the arc with poses that are a little off.
test::SyntheticMap disturbed_map(int keyframes) {
  test::SyntheticMap built;
  Random random(9);
  for (int i = 0; i < keyframes; ++i) {
    const auto view =
        test::observe(world(), true_pose(i), {0.1, 3e-4, 12, 0.2}, 50 + static_cast<uint64_t>(i));
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = i == 0 ? 0 : 0.01 * random.gaussian();
    test::add_view(built, world(), view, true_pose(i) * SE3::exp(error));
  }
  return built;
}

double pose_error_m(const Map& map) {
  double worst = 0;
  for (const Keyframe& keyframe : map.keyframes()) {
    worst = std::max(
        worst, test::distance_m(keyframe.T_world_camera, true_pose(static_cast<int>(keyframe.id.value))));
  }
  return worst;
}

TEST(Adjustment, FullAdjustmentFindsTheTruth) {
  auto built = disturbed_map(8);
  const double before_m = pose_error_m(built.map);
  ASSERT_TRUE(built.map.apply(adjust(full_problem(built.map, world().camera), {})));
  EXPECT_GT(before_m, 0.01);
  EXPECT_LT(pose_error_m(built.map), 0.002);
  built.map.check_invariants();
}

TEST(Adjustment, TheLocalProblemHoldsWhatSurroundsIt) {
  auto built = disturbed_map(10);
  MappingOptions options;
  options.window_keyframes = 4;
  const AdjustmentProblem problem = local_problem(built.map, KeyframeId{9}, world().camera, options);
  EXPECT_EQ(std::count(problem.bundle.fixed.begin(), problem.bundle.fixed.end(), 0), 4);
  EXPECT_GT(std::count(problem.bundle.fixed.begin(), problem.bundle.fixed.end(), 1), 0);
  EXPECT_EQ(problem.bundle.observations.size(), problem.observations.size());
  for (const LandmarkId id : problem.landmarks) EXPECT_GE(built.map.landmark(id).observations.size(), 2U);
  const MapUpdate update = adjust(problem, options.bundle);
  EXPECT_EQ(update.T_world_camera.size(), 4U);
}

TEST(Adjustment, ForgetsWrongObservations) {
  auto built = disturbed_map(6);
  // Swap the landmarks of two far apart key points in one keyframe.
  const Keyframe& keyframe = built.map.keyframe(KeyframeId{3});
  const auto shows = [&](uint32_t i) { return keyframe.landmark_of[i]; };
  uint32_t a = 0;
  while (!shows(a).valid() || built.map.landmark(shows(a)).observations.size() < 4) ++a;
  uint32_t b = a + 1;
  while (!shows(b).valid() || built.map.landmark(shows(b)).observations.size() < 4 ||
         (keyframe.features->pixels[a] - keyframe.features->pixels[b]).norm() < 100) {
    ++b;
  }
  const LandmarkId landmark_a = shows(a), landmark_b = shows(b);
  built.map.forget(landmark_a, {keyframe.id, a});
  built.map.forget(landmark_b, {keyframe.id, b});
  ASSERT_TRUE(built.map.observe(landmark_a, {keyframe.id, b}));
  ASSERT_TRUE(built.map.observe(landmark_b, {keyframe.id, a}));
  built.map.apply(adjust(full_problem(built.map, world().camera), {}));
  EXPECT_FALSE(shows(a).valid());
  EXPECT_FALSE(shows(b).valid());
  EXPECT_LT(pose_error_m(built.map), 0.002);
}

}  // namespace
}  // namespace kinloop
