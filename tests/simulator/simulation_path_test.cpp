// Camera paths: the built-in one, and interpolated recordings.

#include <filesystem>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "simulator/camera_path.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop::sim {
namespace {

double between_m(const SE3& a, const SE3& b) {
  return (a.translation - b.translation).norm();
}

double between_rad(const SE3& a, const SE3& b) {
  return (a.inverse() * b).angle_rad();
}

TEST(HandheldPath, ClosesItsLoopAndMovesLikeAHand) {
  for (const uint64_t seed : {1, 2, 9}) {
    const Trajectory poses = handheld_path(seed);
    const CameraPath path(poses);
    EXPECT_NEAR(static_cast<double>(frame_stamps(poses, 30).size()), 560, 10);

    // Near the end the camera revisits its first views.
    double nearest_m = 1e9, nearest_rad = 1e9;
    for (size_t i = poses.size() * 9 / 10; i < poses.size(); ++i) {
      nearest_m = std::min(nearest_m, between_m(poses[i].T_world_camera, poses[0].T_world_camera));
      nearest_rad = std::min(nearest_rad, between_rad(poses[i].T_world_camera, poses[0].T_world_camera));
    }
    EXPECT_LT(nearest_m, 0.25);
    EXPECT_LT(nearest_rad, 0.35);

    double length_m = 0;
    constexpr int64_t kStep_ns = 10'000'000;
    const double step_s = to_seconds(kStep_ns);
    for (int64_t t = poses.front().stamp_ns; t + 2 * kStep_ns < poses.back().stamp_ns; t += kStep_ns) {
      const SE3 a = path.at(t), b = path.at(t + kStep_ns), c = path.at(t + 2 * kStep_ns);
      length_m += between_m(a, b);
      ASSERT_LT(between_m(a, b) / step_s, 1.0);
      ASSERT_LT(between_rad(a, b) / step_s, 1.4);
      const Eigen::Vector3d acceleration =
          (c.translation - 2 * b.translation + a.translation) / (step_s * step_s);
      ASSERT_LT(acceleration.norm(), 3.0);
    }
    EXPECT_GT(length_m, 6);
  }
}

TEST(CameraPath, PassesSmoothlyThroughItsPoses) {
  Random random(4);
  Trajectory poses;
  for (int i = 0; i < 20; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = random.uniform(-0.3, 0.3);
    poses.push_back({to_ns(0.1 * i + random.uniform(0, 0.04)), SE3::exp(twist)});
  }
  const CameraPath path(poses);
  for (size_t i = 1; i + 1 < poses.size(); ++i) {
    const int64_t t = poses[i].stamp_ns;
    EXPECT_LT(between_m(path.at(t), poses[i].T_world_camera), 1e-9);
    EXPECT_LT(between_rad(path.at(t), poses[i].T_world_camera), 1e-7);
    constexpr int64_t kMoment_ns = 10'000;
    const Vector6d before = (path.at(t - kMoment_ns).inverse() * path.at(t)).log() / to_seconds(kMoment_ns);
    const Vector6d after = (path.at(t).inverse() * path.at(t + kMoment_ns)).log() / to_seconds(kMoment_ns);
    EXPECT_LT((before - after).norm(), 0.02 * (1 + before.norm()));
  }
}

TEST(CameraPath, ASinglePoseStandsStillAndRepeatedStampsAreDropped) {
  const StampedPose pose{to_ns(2), SE3{Eigen::Quaterniond::Identity(), {1, 2, 3}}};
  const CameraPath path({pose, pose});
  EXPECT_EQ(path.poses().size(), 1U);
  EXPECT_LT(between_m(path.at(0), pose.T_world_camera), 1e-12);
  EXPECT_LT(between_m(path.at(to_ns(9)), pose.T_world_camera), 1e-12);
  EXPECT_THROW(CameraPath({}), std::logic_error);
}

TEST(FrameStamps, AreThePathsOwnOrEvenlySpaced) {
  Trajectory poses;
  for (const double t : {1.0, 1.1, 1.1, 1.35, 2.0}) poses.push_back({to_ns(t), {}});
  EXPECT_EQ(frame_stamps(poses, 0), (std::vector<int64_t>{to_ns(1), to_ns(1.1), to_ns(1.35), to_ns(2)}));
  EXPECT_EQ(frame_stamps(poses, 4).size(), 5U);
  EXPECT_EQ(frame_stamps(poses, 4)[3], to_ns(1.75));
}

TEST(FrameStamps, RefuseAPathOfMoreThanADay) {
  const auto error = test::input_error([] { frame_stamps({{0, {}}, {to_ns(1e9), {}}}, 30); });
  EXPECT_THAT(error, testing::HasSubstr("from 0.000000 to 1000000000.000000 s"));
  EXPECT_EQ(frame_stamps({{0, {}}, {to_ns(1e9), {}}}, 0).size(), 2U) << "the path's own";
}

TEST(EstimateUp, FindsTheVerticalInAnyWorld) {
  const Trajectory level = handheld_path(3);
  EXPECT_LT((estimate_up_direction(level) - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  // The world of the first camera, as in visual odometry: tilted like that camera.
  Trajectory relative = level;
  const SE3 T_first_world = level.front().T_world_camera.inverse();
  for (StampedPose& pose : relative) pose.T_world_camera = T_first_world * pose.T_world_camera;
  const Eigen::Vector3d true_up = T_first_world.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_GT(estimate_up_direction(relative).dot(true_up), std::cos(0.21));
  // A camera that never turned: its own -y.
  const Trajectory still{{0, {}}, {1, {}}};
  EXPECT_LT((estimate_up_direction(still) + Eigen::Vector3d::UnitY()).norm(), 1e-9);
}

TEST(EstimateUp, FindsTheLevelWorldOfMotionCapture) {
  const std::filesystem::path folder = test::shared_data("trajectories");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  for (const char* name : {"fr1_room_like.txt", "tum_groundtruth/fr1_desk.txt", "tum_groundtruth/fr1_xyz.txt",
                           "tum_groundtruth/fr3_long_office.txt"}) {
    const Eigen::Vector3d up = estimate_up_direction(read_tum_trajectory(folder / name));
    EXPECT_LT((up - Eigen::Vector3d::UnitZ()).norm(), 1e-9) << name;
  }
}

}  // namespace
}  // namespace kinloop::sim
