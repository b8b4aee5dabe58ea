#include <gtest/gtest.h>

#include "kinloop/mapping/bundle_adjustment.hpp"
#include "kinloop/mapping/landmark_creation.hpp"
#include "kinloop/mapping/mapper.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::camera_at;
using test::pose_on_arc;

const test::SyntheticWorld& world() {
  static const test::SyntheticWorld kWorld = test::make_world(2500, 1);
  return kWorld;
}

TEST(LandmarkCreation, CreatesLandmarksFromDepth) {
  const SE3 towards_a_corner{exp_so3({0, 0.8, 0}), Eigen::Vector3d::Zero()};  // 1.8 to 2.8 m away
  const auto view = test::observe(world(), towards_a_corner, {0, 0, 0, 0.3}, 2);
  Map map;
  const KeyframeId id = map.add_keyframe(FrameId{0}, 0, towards_a_corner, view.features);
  MappingOptions options;
  options.max_depth_m = 2.2;
  const int grown = create_landmarks_from_depth(map, id, world().camera, options, {});
  EXPECT_EQ(static_cast<size_t>(grown), map.landmark_count());
  int expected = 0, too_far = 0;
  for (uint32_t i = 0; i < view.point_of.size(); ++i) {
    const float depth_m = view.features->depths_m[i];
    const LandmarkId landmark = map.keyframe(id).landmark_of[i];
    EXPECT_EQ(landmark.valid(), depth_m > 0 && depth_m <= 2.2F);
    too_far += depth_m > 2.2F ? 1 : 0;
    if (!landmark.valid()) continue;
    ++expected;
    EXPECT_LT((map.p_world(landmark) - world().p_world[view.point_of[i]]).norm(), 1e-3);
  }
  EXPECT_EQ(grown, expected);
  EXPECT_GT(grown, 20);
  EXPECT_GT(too_far, 20);
  // Each keypoint gets only one landmark.
  EXPECT_EQ(create_landmarks_from_depth(map, id, world().camera, options, {}), 0);
  map.check_invariants();
}

/// A camera that moves to the right reads its lower rows later, when everything has moved to the left.
TEST(Mapper, CompensatingTheFirstKeyframeMovesItsLandmarks) {
  const auto view = test::observe(world(), SE3{}, {}, 2);
  Map map;
  const KeyframeId id = map.add_keyframe(FrameId{0}, 0, SE3{}, view.features);
  create_landmarks_from_depth(map, id, world().camera, {}, {});
  const auto before = map.data();
  Sensor sensor = test::sensor_of(world().camera);
  sensor.corrections(kRollingShutter) = sensor.corrections(kDepthShutter) = 0.03;
  const Velocity to_the_right{Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()};
  Mapper({}).compensate_first(map, id, to_the_right, sensor);
  int lower = 0;
  for (uint32_t i = 0; i < view.features->size(); ++i) {
    const LandmarkId landmark = map.keyframe(id).landmark_of[i];
    if (!landmark.valid()) continue;
    const double row =
        static_cast<double>(view.features->measured_pixels[i].y()) / world().camera.height - 0.5;
    const double moved_m = map.p_world(landmark).x() - before.landmarks[landmark.value]->p_anchor.x();
    EXPECT_NEAR(moved_m, 0.03 * row, 1e-3);
    lower += row > 0.25 ? 1 : 0;
  }
  EXPECT_GT(lower, 10);
  EXPECT_EQ(map.landmark_count(), before.landmarks.size());
  map.check_invariants();
}

TEST(LandmarkCreation, WhatHasMovedGetsNoLandmarks) {
  const auto view = test::observe(world(), SE3{}, {}, 2);
  Map map;
  const KeyframeId id = map.add_keyframe(FrameId{0}, 0, SE3{}, view.features);
  const PinholeCamera& camera = world().camera;
  const auto grid = make_surface_camera(test::sensor_of(camera));
  map.set_surfaces(id, std::make_shared<const SurfaceGrid>(make_surface_grid(
                           grid, cv::Mat(camera.height, camera.width, CV_32FC1, cv::Scalar(2.0F)))));
  cv::Mat moved = cv::Mat::zeros(grid->grid.height, grid->grid.width, CV_8UC1);
  moved.colRange(0, moved.cols / 2) = 255;
  EXPECT_GT(create_landmarks_from_depth(map, id, camera, {}, moved), 0);
  int moved_count = 0;
  for (uint32_t i = 0; i < view.features->size(); ++i) {
    if (view.features->measured_pixels[i].x() >= static_cast<float>(camera.width / 2 - 1)) continue;
    ++moved_count;
    EXPECT_FALSE(map.keyframe(id).landmark_of[i].valid());
  }
  EXPECT_GT(moved_count, 0);
}

TEST(LandmarkCreation, MatchesLandmarksOfTheLocalMap) {
  test::SyntheticMap built;
  const auto first = test::observe(world(), SE3{}, {}, 2);
  test::add_view(built, world(), first, SE3{});
  const SE3 pose = pose_on_arc(1);
  const auto second = test::observe(world(), pose, {}, 3);
  const KeyframeId id = built.map.add_keyframe(FrameId{1}, 1, pose, second.features);
  // The local map must be centred on the new keyframe, which has no observations yet, so use the landmarks of
  // the first one.
  LocalMap local_map = make_local_map(built.map, KeyframeId{0}, {});
  const SE3 T_new_first = pose.inverse();
  for (size_t i = 0; i < local_map.size(); ++i) {
    local_map.p_reference[i] = T_new_first * local_map.p_reference[i];
    local_map.viewing_directions[i] = T_new_first.rotation * local_map.viewing_directions[i];
  }
  EXPECT_GT(match_local_map(built.map, id, local_map, world().camera, {}), 80);
  int wrong = 0;
  for (uint32_t i = 0; i < second.point_of.size(); ++i) {
    const LandmarkId landmark = built.map.keyframe(id).landmark_of[i];
    wrong += landmark.valid() && landmark != built.landmark_of_point.at(second.point_of[i]) ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  built.map.check_invariants();
}

TEST(LandmarkCreation, CullsUnconfirmedLandmarks) {
  test::SyntheticMap built;
  for (int i = 0; i < 4; ++i) {
    test::add_view(built, world(), test::observe(world(), pose_on_arc(i), {}, static_cast<uint64_t>(i)),
                   pose_on_arc(i));
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

/// Two views of one wall, and two of another one behind the camera.
TEST(OldestTied, IsTheFirstKeyframeOfEachPartThatSharesLandmarks) {
  test::SyntheticMap built;
  const SE3 back{exp_so3({0, 3.1, 0}), Eigen::Vector3d::Zero()};
  uint64_t seed = 0;
  for (const SE3& pose : {SE3{}, pose_on_arc(1), back, back * pose_on_arc(1)})
    test::add_view(built, world(), test::observe(world(), pose, {}, ++seed), pose);
  const std::vector<KeyframeId> all = {KeyframeId{3}, KeyframeId{0}, KeyframeId{2}, KeyframeId{1}};
  const std::vector<KeyframeId> expected = {KeyframeId{2}, KeyframeId{0}, KeyframeId{2}, KeyframeId{0}};
  EXPECT_EQ(oldest_tied(built.map, all), expected);
  const auto problem = make_global_ba_problem(built.map, test::sensor_of(world().camera));
  EXPECT_EQ(problem.bundle.fixed, (std::vector<uint8_t>{1, 0, 1, 0}));
}

/// Keyframes along the arc with slightly wrong poses.
test::SyntheticMap disturbed_map(int keyframes) {
  test::SyntheticMap built;
  Random random(9);
  for (int i = 0; i < keyframes; ++i) {
    const auto view =
        test::observe(world(), pose_on_arc(i), {0.1, 3e-4, 12, 0.2}, 50 + static_cast<uint64_t>(i));
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = i == 0 ? 0 : 0.01 * random.gaussian();
    test::add_view(built, world(), view, pose_on_arc(i) * SE3::exp(error));
  }
  return built;
}

double pose_error_m(const Map& map) {
  double worst = 0;
  for (const Keyframe& keyframe : map.keyframes()) {
    worst = std::max(
        worst, test::distance_m(keyframe.T_world_camera, pose_on_arc(static_cast<int>(keyframe.id.value))));
  }
  return worst;
}

TEST(BundleAdjustment, GlobalBundleAdjustmentRecoversTheTruth) {
  auto built = disturbed_map(8);
  const double before_m = pose_error_m(built.map);
  ASSERT_TRUE(
      built.map.apply(run_bundle_adjustment(make_global_ba_problem(built.map, Sensor{world().camera}), {})));
  EXPECT_GT(before_m, 0.01);
  EXPECT_LT(pose_error_m(built.map), 0.002);
  built.map.check_invariants();
}

TEST(BundleAdjustment, LocalProblemFixesSurroundingKeyframes) {
  auto built = disturbed_map(10);
  MappingOptions options;
  options.local_ba_keyframes = 4;
  const BundleAdjustmentProblem problem =
      make_local_ba_problem(built.map, KeyframeId{9}, Sensor{world().camera}, options);
  EXPECT_EQ(std::count(problem.bundle.fixed.begin(), problem.bundle.fixed.end(), 0), 4);
  EXPECT_EQ(std::count(problem.bundle.fixed.begin(), problem.bundle.fixed.end(), 1), 6);
  EXPECT_EQ(problem.bundle.observations.size(), problem.observations.size());
  ASSERT_FALSE(problem.landmarks.empty());
  for (const LandmarkId id : problem.landmarks) EXPECT_GE(built.map.landmark(id).observations.size(), 2U);
  const MapUpdate update = run_bundle_adjustment(problem, options.local_ba);
  EXPECT_EQ(update.T_world_camera.size(), 4U);
}

TEST(BundleAdjustment, RemovesOutlierObservations) {
  auto built = disturbed_map(6);
  // Swap the landmarks of two distant keypoints in one keyframe.
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
  built.map.remove_observation(landmark_a, {keyframe.id, a});
  built.map.remove_observation(landmark_b, {keyframe.id, b});
  ASSERT_TRUE(built.map.add_observation(landmark_a, {keyframe.id, b}));
  ASSERT_TRUE(built.map.add_observation(landmark_b, {keyframe.id, a}));
  built.map.apply(run_bundle_adjustment(make_global_ba_problem(built.map, Sensor{world().camera}), {}));
  EXPECT_FALSE(shows(a).valid());
  EXPECT_FALSE(shows(b).valid());
  EXPECT_LT(pose_error_m(built.map), 0.001);
}

}  // namespace
}  // namespace kinloop
