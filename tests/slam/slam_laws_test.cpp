// What the results of Slam do not depend on: the world frame, the origin of time, frame ids, the threads of
// OpenCV.

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "kinloop/slam/slam.hpp"
#include "tests/slam/recording.hpp"

namespace kinloop {
namespace {

const test::Recording& laws_recording() {
  static const test::Recording kRecording = test::record_simulation("sim:room", 40);
  return kRecording;
}

/// Frames [begin, end) of the recording.
std::vector<Frame> frames_of(size_t begin, size_t end) {
  const auto& frames = laws_recording().frames;
  return {frames.begin() + static_cast<std::ptrdiff_t>(begin),
          frames.begin() + static_cast<std::ptrdiff_t>(end)};
}

Trajectory poses_of(Slam& slam, const std::vector<Frame>& frames) {
  for (const Frame& frame : frames) slam.process(frame);
  return slam.finish();
}

/// Largest difference between the poses of two runs.
double largest_difference(const Trajectory& a, const Trajectory& b) {
  if (a.size() != b.size()) return 1e9;
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const SE3 &x = a[i].T_world_camera, &y = b[i].T_world_camera;
    largest = std::max({largest, (x.translation - y.translation).norm(),
                        (x.rotation.coeffs() - y.rotation.coeffs()).norm()});
  }
  return largest;
}

TEST(SlamLaws, TheOriginOfTimeDoesNotMatter) {
  Slam slam(laws_recording().camera), later_slam(laws_recording().camera);
  auto later = frames_of(0, 40);
  for (Frame& frame : later) {
    frame.stamp_ns += 1'700'000'000'000'000'000;  // in 2023
    if (frame.depth_stamp_ns) *frame.depth_stamp_ns += 1'700'000'000'000'000'000;
  }
  EXPECT_EQ(largest_difference(poses_of(slam, frames_of(0, 40)), poses_of(later_slam, later)), 0);
}

/// Seeds are those of frame ids, so that the samples of RANSAC differ.
TEST(SlamLaws, FrameIdsDoNotMatter) {
  Slam slam(laws_recording().camera), shifted_slam(laws_recording().camera);
  auto shifted = frames_of(0, 40);
  for (Frame& frame : shifted) frame.id.value += 100'000;
  EXPECT_LT(largest_difference(poses_of(slam, frames_of(0, 40)), poses_of(shifted_slam, shifted)), 1e-9);
}

/// A saved map is continued in the frame of its world, wherever that is. Landmarks are adjusted along the
/// axes of the world, so that a rotation changes where an adjustment stops within its tolerance.
TEST(SlamLaws, TheWorldFrameDoesNotMatter) {
  Slam first(laws_recording().camera);
  poses_of(first, frames_of(0, 25));
  const SavedMap saved = first.saved_map("first");
  const auto continued = [&](const SE3& T_new_world) {
    SavedMap moved = saved;
    for (Keyframe& keyframe : moved.map.keyframes)
      keyframe.T_world_camera = T_new_world * keyframe.T_world_camera;
    Slam slam(laws_recording().camera);
    slam.add_map(moved);
    return poses_of(slam, frames_of(25, 40));
  };
  const auto difference_in = [&](const SE3& T_new_world) {
    Trajectory here = continued({});
    for (StampedPose& pose : here) pose.T_world_camera = T_new_world * pose.T_world_camera;
    return largest_difference(here, continued(T_new_world));
  };
  ASSERT_EQ(continued({}).size(), 15U);  // the first one is confirmed by the next ones
  EXPECT_LT(difference_in({Eigen::Quaterniond::Identity(), {30, -20, 10}}), 1e-12);
  EXPECT_LT(difference_in({exp_so3({0.2, 1, -0.3}), {30, -20, 10}}), 3e-5);
}

/// A library that turned them off for the whole process would slow down its caller. (See FrontEnd's test for
/// each kind of feature.)
TEST(SlamLaws, TheThreadsOfOpenCvDoNotMatter) {
  const int before = cv::getNumThreads();
  const auto run = [](int threads) {
    cv::setNumThreads(threads);
    Slam slam(laws_recording().camera);
    Trajectory poses = poses_of(slam, frames_of(0, 20));
    EXPECT_EQ(cv::getNumThreads(), threads) << "they are the caller's";
    return poses;
  };
  const Trajectory alone = run(1);
  EXPECT_EQ(alone.size(), 20U);
  EXPECT_EQ(largest_difference(alone, run(4)), 0);
  cv::setNumThreads(before);
}

}  // namespace
}  // namespace kinloop
