// What interrupts the motion of a camera: gaps, other rooms, frozen images. No pose may be wrong without a
// mark.

#include <gtest/gtest.h>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/slam/slam.hpp"
#include "simulator/camera_path.hpp"
#include "tests/slam/recording.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::record_simulation;
using test::Recording;

constexpr int64_t kInterval_ns = 100'000'000;

/// Numbers and stamps frames anew, as if they had been taken one after the other.
std::vector<Frame> in_sequence(std::vector<Frame> frames) {
  for (uint32_t i = 0; i < frames.size(); ++i) {
    frames[i].id = FrameId{i};
    frames[i].stamp_ns = kInterval_ns * (i + 1);
    frames[i].depth_stamp_ns = frames[i].stamp_ns;
  }
  return frames;
}

/// Returns how many frames from `first` on are located in the component of the first frame.
int count_joined(const Slam& slam, size_t first) {
  int count = 0;
  for (size_t i = first; i < slam.log().size(); ++i) {
    const LoggedFrame& entry = slam.log()[i];
    count += !entry.is_lost() && slam.map().keyframe(entry.reference).component == 0 ? 1 : 0;
  }
  return count;
}

TEST(Discontinuity, AnotherRoomIsAnotherComponent) {
  for (const char* other : {"sim:room:2", "sim:room:5"}) {
    std::vector<Frame> frames = record_simulation("sim:room", 10).frames;
    const Recording second = record_simulation(other, 12);
    frames.insert(frames.end(), second.frames.begin(), second.frames.end());
    Slam slam(second.camera);
    for (const Frame& frame : in_sequence(frames)) slam.process(frame);
    slam.finish();
    EXPECT_EQ(count_joined(slam, 10), 0) << other;
    EXPECT_EQ(slam.map().component_count(), 2U) << other;
  }
}

TEST(Discontinuity, AFrozenImageIsPredictedAndTrackingGoesOnAfterIt) {
  Recording recording = record_simulation("sim:room", 40);
  for (size_t i = 15; i < 30; ++i) recording.frames[i].color = recording.frames[14].color;
  Slam slam(recording.camera);
  for (const Frame& frame : recording.frames) slam.process(frame);
  const Trajectory trusted = slam.finish();
  ASSERT_EQ(trusted.size(), 40U);
  const auto error_m = [&](size_t i) {
    const SE3 T_world_truth =
        recording.truth.front().T_world_camera.inverse() * recording.truth[i].T_world_camera;
    return (trusted[i].T_world_camera.translation - T_world_truth.translation).norm();
  };
  for (size_t i = 15; i < 30; ++i) {
    EXPECT_EQ(slam.log()[i].method, TrackingMethod::kPredicted) << i;
    EXPECT_LT(error_m(i), 4 * position_sigma_m(slam.log()[i].world_covariance)) << i;
  }
  for (size_t i = 30; i < 40; ++i) {
    EXPECT_FALSE(slam.log()[i].is_lost() || slam.log()[i].is_doubtful()) << i;
    EXPECT_LT(error_m(i), 0.02) << i;
  }
}

/// A second of the built-in path, and after ten more seconds a walk of 5 cm a frame ahead from its middle.
Trajectory path_with_approach() {
  constexpr int kFrames = 10, kAgain = kFrames / 2;
  constexpr double kStep_m = 0.05;
  const Trajectory built_in = sim::handheld_path(1);
  const auto pose = [&](int i) {
    return *pose_at(built_in, built_in.front().stamp_ns + i * kInterval_ns, kNsPerSecond);
  };
  Trajectory path;
  for (int i = 0; i < kFrames; ++i) path.push_back({i * kInterval_ns, pose(i)});
  for (int i = 0; i < kFrames; ++i) {
    const SE3 T_camera_ahead(Eigen::Quaterniond::Identity(), {0, 0, kStep_m * i});
    path.push_back({10 * kNsPerSecond + i * kInterval_ns, pose(kAgain) * T_camera_ahead});
  }
  return path;
}

TEST(Discontinuity, AMotionAheadAfterAGapIsNoChangeOfTheScaleOfDepth) {
  SimulationOptions options;
  options.width = 320;
  options.height = 240;
  options.remove_noise();
  SimulatedSource source("approach", 1, options, 2, path_with_approach());
  Slam slam(source.camera());
  while (auto frame = source.next()) slam.process(*frame);
  ASSERT_EQ(slam.log().size(), 20U);
  EXPECT_GE(count_joined(slam, 10), 8) << "the camera is located again";
  for (const LoggedFrame& entry : slam.log())
    EXPECT_EQ(entry.evidence.input.depth_factor, 1) << entry.stamp_ns;
}

class FaultyInput : public testing::TestWithParam<const char*> {};

TEST_P(FaultyInput, IsNotJoinedToWhatItDoesNotContinue) {
  const auto folder = test::shared_data("faults") / GetParam();
  KINLOOP_SKIP_WITHOUT(folder);
  TumSource source(folder);
  Slam slam(source.camera());
  while (auto frame = source.next()) slam.process(*frame);
  slam.finish();
  EXPECT_EQ(count_joined(slam, 10), 0);
  EXPECT_EQ(count_joined(slam, 0), 10);
}

INSTANTIATE_TEST_SUITE_P(Shared, FaultyInput, testing::Values("gap_1", "gap_2", "two_rooms"));

}  // namespace
}  // namespace kinloop
