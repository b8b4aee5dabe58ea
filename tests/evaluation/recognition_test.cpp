// What is found by comparing two trajectories: the offset of their clocks and the order of their quaternions.

#include "tools/evaluation/recognition.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "tests/support/random_vectors.hpp"
#include "tests/support/shared_data.hpp"
#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop {
namespace {

constexpr int64_t kStepOfClipNs = 33'333'333;

/// A motion that does not repeat itself.
SE3 pose_of_walk(double t_s) {
  const double phase = t_s + 0.6 * std::sin(0.31 * t_s * t_s / 10);
  return {exp_so3({0.4 * std::sin(phase), 0.2 * t_s, 0.3 * std::cos(1.7 * phase)}),
          {std::sin(phase), std::cos(1.3 * phase), 0.3 * std::sin(0.7 * t_s)}};
}

/// Poses from `from_s` on, in a world of their own, with the stamps of a clock that is `clock_ns` ahead.
Trajectory clip(double from_s, int frames, int64_t clock_ns = 0, const SE3& T_own_world = {}) {
  Random random(5);
  Trajectory poses;
  for (int i = 0; i < frames; ++i) {
    const int64_t stamp_ns = to_ns(from_s) + i * kStepOfClipNs;
    SE3 pose = T_own_world * pose_of_walk(to_seconds(stamp_ns));
    pose.translation += 0.002 * test::gaussian_vector<3>(random);
    poses.push_back({stamp_ns + clock_ns, pose});
  }
  return poses;
}

const SE3 kOtherWorld{exp_so3({0.4, -1.1, 0.7}), {3, -2, 5}};

TEST(ClockOffset, IsFoundWithoutACommonWorldOrTime) {
  const Trajectory truth = clip(0, 1500);
  for (const double offset_s : {0.0, 0.25, -3.2, 1e9}) {
    const auto found = estimate_clock_offset(clip(10, 600, to_ns(-offset_s), kOtherWorld), truth);
    ASSERT_TRUE(found) << offset_s;
    EXPECT_NEAR(to_seconds(*found - to_ns(offset_s)), 0, 2e-3);
  }
}

TEST(ClockOffset, IsUnknownWhereTheMotionDoesNotTell) {
  const Trajectory truth = clip(0, 900);
  EXPECT_FALSE(estimate_clock_offset(clip(10, 60), truth)) << "two seconds";
  EXPECT_FALSE(estimate_clock_offset({}, truth));
  EXPECT_FALSE(estimate_clock_offset(clip(200, 900), truth)) << "another motion";
  Trajectory circles;
  for (int i = 0; i < 900; ++i) {
    const double t = to_seconds(i * kStepOfClipNs);
    circles.push_back(
        {i * kStepOfClipNs, {exp_so3({0, 0.5 * std::sin(t), 0}), {std::sin(t), std::cos(2 * t), 0}}});
  }
  EXPECT_FALSE(estimate_clock_offset(shifted(circles, 3 * kNsPerSecond), circles)) << "a motion that repeats";
}

TEST(ClockOffset, OfRealTrajectoriesIsLessThanAFrame) {
  const auto folder = test::shared_data("trajectories");
  KINLOOP_SKIP_WITHOUT(folder);
  const auto truth = read_trajectory_file(folder / "tum_groundtruth/fr2_desk.txt").poses;
  const auto estimate = read_trajectory_file(folder / "known_ate/fr2_desk_orbslam2.txt").poses;
  const auto found = estimate_clock_offset(shifted(estimate, 7'300'000'000), truth);
  ASSERT_TRUE(found);
  EXPECT_NEAR(to_seconds(*found + 7'300'000'000), 0, 0.02);
}

TEST(QuaternionOrder, IsFoundWhicheverOneIsReadWrongly) {
  const Trajectory truth = clip(0, 600), estimate = clip(0, 600, 0, kOtherWorld);
  const auto misread = [](Trajectory poses) {
    for (auto& pose : poses) {
      const auto q = pose.T_world_camera.rotation;
      pose.T_world_camera.rotation = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
    }
    return poses;
  };
  EXPECT_LT((with_w_first(misread(truth))[9].T_world_camera.inverse() * truth[9].T_world_camera).log().norm(),
            1e-9);

  const WhichTrajectory any{true, true};
  const auto expect = [](const WhichTrajectory& found, bool in_estimate, bool in_truth) {
    EXPECT_EQ(found.estimate, in_estimate);
    EXPECT_EQ(found.truth, in_truth);
  };
  expect(find_w_first(estimate, truth, any), false, false);
  expect(find_w_first(misread(estimate), truth, any), true, false);
  expect(find_w_first(estimate, misread(truth), any), false, true);
  expect(find_w_first(misread(estimate), misread(truth), any), true, true);
  expect(find_w_first(misread(estimate), truth, {false, true}), false, false);
  expect(find_w_first({}, truth, any), false, false);
}

}  // namespace
}  // namespace kinloop
