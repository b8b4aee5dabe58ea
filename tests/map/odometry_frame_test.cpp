#include "kinloop/map/frames/odometry_frame.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

/// A map, the camera that moves in it, and its odometry.
class OdometryFrameTest : public testing::Test {
 protected:
  KeyframeId add_keyframe(const SE3& T_world_keyframe, uint32_t component = 0) {
    const auto frame = static_cast<uint32_t>(map_.keyframes().size());
    return map_.add_keyframe(FrameId{frame}, frame, T_world_keyframe, std::make_shared<const Features>(),
                             component);
  }

  /// Tracks a frame and returns the pose in the frame of the odometry.
  SE3 track(KeyframeId reference, const SE3& T_reference_camera,
            TrackingOutcome outcome = TrackingOutcome::kTracked) {
    TrackedFrame tracked;
    tracked.outcome = outcome;
    tracked.reference = reference;
    tracked.T_reference_camera = T_reference_camera;
    odometry_.update(tracked, map_);
    return odometry_.T_map_odom().inverse() * map_.keyframe(reference).T_world_camera * T_reference_camera;
  }

  void lose() { odometry_.update({}, map_); }

  void correct(KeyframeId keyframe, const SE3& T_world_keyframe) {
    MapUpdate update;
    update.T_world_camera = {{keyframe, T_world_keyframe}};
    update.newest_keyframe = map_.keyframes().back().id;
    update.epoch = map_.epoch();
    ASSERT_TRUE(map_.apply(update));
  }

  Map map_;
  OdometryFrame odometry_;
};

void expect_near(const SE3& a, const SE3& b) {
  EXPECT_LT((a.inverse() * b).log().norm(), 1e-9);
}

TEST_F(OdometryFrameTest, CorrectionsOfTheMapDoNotMoveTheCameraInOdometry) {
  const KeyframeId keyframe = add_keyframe({});
  for (int i = 0; i < 6; ++i) {
    const SE3 T_reference_camera = test::pose_on_arc(i);
    // Without corrections, the camera would be there.
    expect_near(track(keyframe, T_reference_camera), T_reference_camera);
    lose();  // changes nothing
    correct(keyframe, test::camera_at(0.3 * i, {1.0 * i, 2, 3}));
  }
  lose();  // the last correction is taken up at once
  EXPECT_GT(odometry_.T_map_odom().translation.norm(), 1);
}

TEST_F(OdometryFrameTest, APlaceThatIsRecognizedDoesNotMoveTheCameraInOdometry) {
  const KeyframeId keyframe = add_keyframe({});
  const SE3 before = track(keyframe, test::pose_on_arc(1));
  lose();
  expect_near(track(keyframe, test::camera_at(1, {2, 0, 1}), TrackingOutcome::kRelocalized), before);
  const SE3 step = test::pose_on_arc(1);
  expect_near(track(keyframe, test::camera_at(1, {2, 0, 1}) * step), before * step);
}

TEST_F(OdometryFrameTest, AMapThatBeginsAnewBeginsWhereTheCameraWas) {
  const SE3 before = track(add_keyframe({}), test::pose_on_arc(3));
  lose();
  const KeyframeId second = add_keyframe({}, 1);
  expect_near(track(second, {}, TrackingOutcome::kNewMap), before);
  expect_near(track(second, test::pose_on_arc(2)), before * test::pose_on_arc(2));
}

TEST_F(OdometryFrameTest, AnotherPartOfAMapThatIsPartedIsNoMotion) {
  const KeyframeId first = add_keyframe({});
  const KeyframeId second = add_keyframe(test::camera_at(0, {5, 0, 0}), 1);
  const SE3 before = track(first, test::pose_on_arc(3));
  expect_near(track(second, {}), before);
}

}  // namespace
}  // namespace kinloop
