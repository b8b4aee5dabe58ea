// What place recognition must accept from any viewpoint, and what it must never accept.

#include <gtest/gtest.h>

#include "kinloop/loop/recognition/recognize_place.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

/// A place seen from three keyframes.
class RecognitionLaws : public testing::TestWithParam<uint64_t> {
 protected:
  RecognitionLaws() {
    for (int i = 0; i < 3; ++i) {
      const auto view = seen(world_, pose(i), hash(GetParam(), static_cast<uint64_t>(i)));
      test::add_view(built_, world_, view, pose(i));
    }
    local_map_ = make_local_map(built_.map, KeyframeId{1}, {});
  }

  static SE3 pose(int i) { return test::camera_at(0.06 * i, {0.05 * i, 0, 0}); }

  /// A view whose depths can be compared: each keypoint lies on a plane that faces the camera.
  static test::SyntheticView seen(const test::SyntheticWorld& world, const SE3& T_world_camera,
                                  uint64_t seed) {
    test::SyntheticView view = test::observe(world, T_world_camera, {}, seed);
    Features features = *view.features;
    features.inverse_depth_gradients.assign(features.size(), Eigen::Vector2f::Zero());
    view.features = std::make_shared<const Features>(std::move(features));
    return view;
  }

  /// The pose relative to the reference of a camera at `T_reference_camera` in `world`.
  [[nodiscard]] std::optional<TrackedFrame> recognize(const test::SyntheticWorld& world,
                                                      const SE3& T_reference_camera) {
    const auto view = seen(world, pose(1) * T_reference_camera, random_.next());
    const Frame frame = test::make_frame(9, view);
    return recognize_place({frame, local_map_, sensor_, {}}, options_, random_.next());
  }

  Random random_{GetParam()};
  test::SyntheticWorld world_ = test::make_world(3000, GetParam());
  Sensor sensor_{world_.camera};
  test::SyntheticMap built_;
  LocalMap local_map_;
  LoopOptions options_;
};

TEST_P(RecognitionLaws, TheSamePlaceIsAcceptedFromAnyNearbyViewpoint) {
  for (int trial = 0; trial < 8; ++trial) {
    const SE3 truth = test::random_step(random_, 0.15, 0.08);
    const auto found = recognize(world_, truth);
    ASSERT_TRUE(found.has_value()) << trial;
    EXPECT_LT(test::distance_m(found->T_reference_camera, truth), 0.01);
    EXPECT_LT(test::angle_rad(found->T_reference_camera, truth), 0.005);
  }
}

TEST_P(RecognitionLaws, TheRollOfTheCameraDoesNotMatter) {
  const SE3 rolled{exp_so3({0, 0, 1.2}), {0.05, 0, 0}};
  const auto found = recognize(world_, rolled);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(test::distance_m(found->T_reference_camera, rolled), 0.01);
}

TEST_P(RecognitionLaws, AMirroredRoomIsRejected) {
  for (int axis = 0; axis < 2; ++axis) {
    test::SyntheticWorld mirrored = world_;
    // In the camera's axes, so that the same points stay in view.
    for (Eigen::Vector3d& p : mirrored.p_world) {
      Eigen::Vector3d p_camera = pose(1).inverse() * p;
      p_camera[axis] = -p_camera[axis];
      p = pose(1) * p_camera;
    }
    EXPECT_FALSE(recognize(mirrored, {}).has_value()) << axis;
  }
}

TEST_P(RecognitionLaws, TheSameTextureOnAnotherShapeIsRejected) {
  test::SyntheticWorld scaled = world_, shuffled = world_;
  for (Eigen::Vector3d& p : scaled.p_world) p = pose(1) * (1.3 * (pose(1).inverse() * p));
  EXPECT_FALSE(recognize(scaled, {}).has_value()) << "the same picture, 1.3 times as far";
  const auto order = sample_without_replacement(random_, 3000, 3000);
  for (size_t i = 0; i < order.size(); ++i) shuffled.p_world[i] = world_.p_world[order[i]];
  EXPECT_FALSE(recognize(shuffled, {}).has_value());
}

TEST_P(RecognitionLaws, AnotherRoomAndTheOtherSideAreRejected) {
  EXPECT_FALSE(recognize(test::make_world(3000, GetParam() + 1000), {}).has_value());
  EXPECT_FALSE(recognize(world_, test::camera_at(3.14159, {0, 0, 0})).has_value());
}

/// Each requirement alone can refuse a place.
TEST_P(RecognitionLaws, EveryRequirementCounts) {
  const auto found = recognize(world_, {});
  ASSERT_TRUE(found.has_value());
  const auto accepts = [&](const auto& demand) {
    options_ = {};
    demand(options_);
    return recognize(world_, {}).has_value();
  };
  EXPECT_FALSE(accepts([&](auto& o) { o.min_inliers = 2 * found->evidence.inliers; }));
  EXPECT_FALSE(accepts([](auto& o) { o.min_inlier_ratio = 1.01; }));
  EXPECT_FALSE(accepts([](auto& o) { o.max_hamming_distance = 3; }));
  EXPECT_FALSE(accepts([](auto& o) { o.min_matches = 100000; }));
  EXPECT_FALSE(accepts([](auto& o) { o.min_p_value = 1.01; }));
  EXPECT_TRUE(accepts([](auto&) {}));
}

INSTANTIATE_TEST_SUITE_P(Rooms, RecognitionLaws, testing::Values(1, 2, 3, 4));

}  // namespace
}  // namespace kinloop
