#include "tools/export/trajectory_writer.hpp"

#include <gmock/gmock.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop {
namespace {

Trajectory some_poses() {
  Trajectory poses;
  for (int i = 0; i < 5; ++i)
    poses.push_back({1'000'000'000LL + i * 33'000'000, {exp_so3({0.1 * i, -0.2, 0.3}), {0.1 * i, 2, -3}}});
  return poses;
}

TEST(TrajectoryWriter, WhatItWritesIsReadAgainInEachFormat) {
  const test::TempFolder folder;
  const Trajectory poses = some_poses();
  for (const char* name : {"t.txt", "t.csv", "t.kitti"}) {
    write_trajectory_file(folder.path() / name, poses, "a note");
    const TrajectoryFile read = read_trajectory_file(folder.path() / name);
    ASSERT_EQ(read.poses.size(), poses.size()) << name;
    EXPECT_EQ(read.has_stamps, !is_kitti_name(name));
    for (size_t i = 0; i < poses.size(); ++i) {
      EXPECT_LT((read.poses[i].T_world_camera.inverse() * poses[i].T_world_camera).log().norm(), 1e-8)
          << name;
      if (read.has_stamps) {
        EXPECT_EQ(read.poses[i].stamp_ns, poses[i].stamp_ns) << name;
      }
    }
  }
}

TEST(TrajectoryWriter, KittiIsRefusedWhereAFrameHasNoPose) {
  EXPECT_NO_THROW(require_pose_of_each_frame("t.kitti", 7, 7));
  EXPECT_NO_THROW(require_pose_of_each_frame("t.txt", 5, 7));
  EXPECT_THAT(
      test::input_error([] { require_pose_of_each_frame("t.kitti", 5, 7); }),
      testing::HasSubstr("t.kitti: KITTI format has a line for each frame, but 2 of 7 frames have no pose"));
}

}  // namespace
}  // namespace kinloop
