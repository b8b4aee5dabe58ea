#include <algorithm>

#include <gtest/gtest.h>

#include "apps/run/summary/loop_pictures.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::camera_at;

/// A camera that turns away from a wall and back. The ends of the loop, i.e. the first and last keyframe, do
/// not overlap; successive keyframes do.
class LoopOverlap : public testing::Test {
 protected:
  LoopOverlap() {
    noise_.missing_depth_fraction = 0;
    noise_.sigma_px = 0;
    for (const double yaw_rad : {-0.3, -0.1, 0.1, 0.8, 1.5, 2.2, 1.5, 0.8, 0.5, 0.12, 0.4}) {
      const SE3 T_world_camera = camera_at(yaw_rad, {0.05, 0, 0});
      const auto view = test::observe(world_, T_world_camera, noise_, ++seed_);
      test::add_view(built_, world_, view, T_world_camera);
    }
    loop_.a = KeyframeId{0};
    loop_.b = KeyframeId{10};
  }

  [[nodiscard]] int shared(uint32_t a, uint32_t b) const {
    for (const auto& [id, count] : built_.map.covisible_keyframes(KeyframeId{a}, 1)) {
      if (id.value == b) return count;
    }
    return 0;
  }

  [[nodiscard]] MovingSensor still() const { return {Sensor{world_.camera}, {}}; }

  test::SyntheticWorld world_ = test::make_world(4000, 1);
  test::ObservationNoise noise_;
  test::SyntheticMap built_;
  LoopClosure loop_;
  uint64_t seed_ = 0;
};

TEST_F(LoopOverlap, ChoosesThePairSharingMostLandmarks) {
  const KeyframePair pair = most_overlapping_pair(built_.map, loop_);
  EXPECT_EQ(pair.older, KeyframeId{2});
  EXPECT_EQ(pair.newer, KeyframeId{9});
  EXPECT_EQ(pair.shared, shared(2, 9));
  EXPECT_GT(pair.shared, shared(0, 10) + 100);
}

TEST_F(LoopOverlap, PairEndsStayOnTheirSideOfTheLoop) {
  std::swap(loop_.a, loop_.b);
  EXPECT_EQ(most_overlapping_pair(built_.map, loop_).older, KeyframeId{2}) << "in either order of the ends";
  loop_ = {.a = KeyframeId{1}, .b = KeyframeId{2}, .T_a_b = {}};
  const KeyframePair pair = most_overlapping_pair(built_.map, loop_);
  EXPECT_EQ(pair.older, KeyframeId{1});
  EXPECT_EQ(pair.newer, KeyframeId{2});
}

TEST_F(LoopOverlap, LandmarksProjectToTheirKeypoints) {
  const auto landmarks = reproject_landmarks(built_.map, KeyframeId{2}, KeyframeId{9}, still());
  int observed = 0;
  for (const auto& landmark : landmarks) {
    EXPECT_TRUE(world_.camera.contains(landmark.predicted));
    EXPECT_GT(landmark.depth_m, 0);
    if (!landmark.observed_in_second) continue;
    ++observed;
    EXPECT_LT((landmark.predicted - *landmark.observed_in_second).norm(), 1e-3);
  }
  EXPECT_EQ(observed, shared(2, 9));
}

TEST_F(LoopOverlap, WrongPoseGivesLargeResiduals) {
  const SE3 T_right = built_.map.keyframe(KeyframeId{9}).T_world_camera;
  MapUpdate update;
  Vector6d error;
  error << 0.1, 0, 0, 0, 0, 0;
  update.T_world_camera.emplace_back(KeyframeId{9}, T_right * SE3::exp(error));
  update.newest_keyframe = KeyframeId{10};
  update.epoch = built_.map.epoch();
  ASSERT_TRUE(built_.map.apply(update));
  std::vector<double> errors_px;
  for (const auto& landmark : reproject_landmarks(built_.map, KeyframeId{2}, KeyframeId{9}, still())) {
    if (landmark.observed_in_second)
      errors_px.push_back((landmark.predicted - *landmark.observed_in_second).norm());
  }
  ASSERT_GT(errors_px.size(), 100U);
  std::sort(errors_px.begin(), errors_px.end());
  EXPECT_GT(errors_px[errors_px.size() / 2], 10);
}

/// While the camera turns by 1 rad/s with a readout time of 0.03 s, the rows above and below the middle are
/// shifted by up to 8 px.
TEST_F(LoopOverlap, RollingShutterShiftsRows) {
  MovingSensor moving = still();
  moving.sensor.corrections(kRollingShutter) = 0.03;
  moving.velocity.angular_rad_s.y() = 1;
  const auto at_rest = reproject_landmarks(built_.map, KeyframeId{2}, KeyframeId{2}, still());
  const auto read = reproject_landmarks(built_.map, KeyframeId{2}, KeyframeId{2}, moving);
  int compared = 0;
  for (const auto& before : at_rest) {
    for (const auto& after : read) {
      if (after.observed != before.observed) continue;
      ++compared;
      const double row = after.predicted.y() / world_.camera.height - 0.5;
      const Eigen::Vector3d ray((before.predicted.x() - world_.camera.cx) / world_.camera.fx,
                                (before.predicted.y() - world_.camera.cy) / world_.camera.fy, 1);
      const Eigen::Vector3d turned = exp_so3({0, 0.03 * row, 0}).conjugate() * ray;
      EXPECT_LT((world_.camera.project(turned) - after.predicted).norm(), 0.002);
    }
  }
  EXPECT_GT(compared, 100);
}

}  // namespace
}  // namespace kinloop
