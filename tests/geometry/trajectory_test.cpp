#include "kinloop/geometry/trajectory.hpp"

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::shared_data;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

double pose_distance(const SE3& a, const SE3& b) {
  return (a.matrix() - b.matrix()).norm();
}

Trajectory random_trajectory(size_t count) {
  Random random(3);
  Trajectory trajectory;
  for (size_t i = 0; i < count; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist(k) = random.gaussian();
    trajectory.push_back({1305031910765238000 + static_cast<int64_t>(i) * 33333000, SE3::exp(twist)});
  }
  return trajectory;
}

class TrajectoryFile : public testing::Test {
 protected:
  Trajectory read(const std::string& text) const { return read_tum_trajectory(folder_.write("t.txt", text)); }
  std::string error(const std::string& text) const {
    return input_error([&] { read(text); });
  }

  TempFolder folder_;
};

TEST_F(TrajectoryFile, ReadingWhatWasWritten) {
  const Trajectory trajectory = random_trajectory(100);
  const auto path = folder_.path() / "t.txt";
  write_tum_trajectory(path, trajectory);
  const Trajectory again = read_tum_trajectory(path);
  ASSERT_EQ(again.size(), trajectory.size());
  for (size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_EQ(again[i].stamp_ns, trajectory[i].stamp_ns);
    EXPECT_LT(pose_distance(again[i].T_world_camera, trajectory[i].T_world_camera), 1e-8);
  }
}

TEST_F(TrajectoryFile, WritingWhatWasReadGivesTheSameBytes) {
  const auto first = folder_.path() / "first.txt", second = folder_.path() / "second.txt";
  write_tum_trajectory(first, random_trajectory(10));
  write_tum_trajectory(second, read_tum_trajectory(first));
  EXPECT_EQ(read_file(first), read_file(second));
}

TEST_F(TrajectoryFile, FormatIsThatOfTheTumTools) {
  write_tum_trajectory(folder_.path() / "t.txt", {{1500000000, {exp_so3({0, 0, 0}), {1, -2, 0.5}}}});
  EXPECT_EQ(
      read_file(folder_.path() / "t.txt"),
      "1.500000 1.000000000 -2.000000000 0.500000000 0.000000000 0.000000000 0.000000000 1.000000000\n");
}

TEST_F(TrajectoryFile, BeginsWithTheComment) {
  const auto path = folder_.path() / "t.txt";
  write_tum_trajectory(path, random_trajectory(2), "2 poses");
  EXPECT_TRUE(read_file(path).starts_with("# 2 poses\n"));
  EXPECT_EQ(read_tum_trajectory(path).size(), 2U);
}

TEST_F(TrajectoryFile, RowsAreSortedByTime) {
  const auto trajectory = read("2 0 0 2 0 0 0 1\n1 0 0 1 0 0 0 1\n");
  ASSERT_THAT(trajectory, SizeIs(2));
  EXPECT_EQ(trajectory[0].stamp_ns, 1000000000);
  EXPECT_EQ(trajectory[0].T_world_camera.translation.z(), 1);
}

TEST_F(TrajectoryFile, QuaternionsAreNormalised) {
  const auto trajectory = read("1 0 0 0 0 0 2 2\n");
  EXPECT_NEAR(trajectory[0].T_world_camera.rotation.norm(), 1, 1e-15);
  EXPECT_NEAR(trajectory[0].T_world_camera.angle_rad(), 1.5707963267948966, 1e-12);
}

TEST_F(TrajectoryFile, CommentsAndNothing) {
  EXPECT_THAT(read("# t x y z q\n\n"), IsEmpty());
  EXPECT_THAT(input_error([&] { read_tum_trajectory(folder_.path() / "none"); }), HasSubstr("no such file"));
}

TEST_F(TrajectoryFile, BadRowsAreNamed) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_THAT(error(good + "2 0 0 0 0 0 0\n"), AllOf(HasSubstr("t.txt:2:"), HasSubstr("7 fields")));
  EXPECT_THAT(error("# kitti\n1 0 0 0 0 1 0 0 0 0 1 0\n"),
              AllOf(HasSubstr("t.txt:2:"), HasSubstr("12 fields")));
  EXPECT_THAT(error(good + good + "3 0 nan 0 0 0 0 1\n"), AllOf(HasSubstr("t.txt:3:"), HasSubstr("'nan'")));
  EXPECT_THAT(error("1 0 0 0 0 0 0 inf\n"), HasSubstr("'inf'"));
  EXPECT_THAT(error("nan 0 0 0 0 0 0 1\n"), AllOf(HasSubstr("t.txt:1:"), HasSubstr("time stamp")));
  EXPECT_THAT(error("1,0,0,0,0,0,0,1\n"), HasSubstr("1 fields"));
  EXPECT_THAT(error("1 0 0 zero 0 0 0 1\n"), HasSubstr("'zero'"));
  EXPECT_THAT(error("1 0 0 0 0 0 0 0\n"), HasSubstr("quaternion is zero"));
}

TEST_F(TrajectoryFile, RealGroundTruth) {
  const auto path = shared_data("rgbd_dataset_freiburg1_desk_9frames/groundtruth.txt");
  KINLOOP_SKIP_WITHOUT(path);
  const Trajectory trajectory = read_tum_trajectory(path);
  ASSERT_THAT(trajectory, SizeIs(2335));
  EXPECT_EQ(trajectory[0].stamp_ns, *parse_stamp_ns("1305031449.7996"));
  EXPECT_EQ(trajectory[0].T_world_camera.translation, Eigen::Vector3d(1.2334, -0.0113, 1.6941));
}

TEST(PoseAt, IsExactAtStampsAndBetweenThemOnTheWay) {
  const Trajectory trajectory = random_trajectory(5);
  const int64_t gap_ns = trajectory[1].stamp_ns - trajectory[0].stamp_ns;
  for (const auto& [stamp_ns, T] : trajectory) {
    const auto pose = pose_at(trajectory, stamp_ns, 0);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->matrix(), T.matrix());
  }
  const auto third = pose_at(trajectory, trajectory[1].stamp_ns + gap_ns / 3, gap_ns);
  ASSERT_TRUE(third);
  EXPECT_LT(
      pose_distance(*third, interpolate(trajectory[1].T_world_camera, trajectory[2].T_world_camera, 1.0 / 3)),
      1e-9);
}

TEST(PoseAt, NothingOutsideNorInsideALongGap) {
  const Trajectory trajectory = random_trajectory(3);
  const int64_t gap_ns = trajectory[1].stamp_ns - trajectory[0].stamp_ns;
  EXPECT_FALSE(pose_at(trajectory, trajectory.front().stamp_ns - 1, gap_ns));
  EXPECT_FALSE(pose_at(trajectory, trajectory.back().stamp_ns + 1, gap_ns));
  EXPECT_TRUE(pose_at(trajectory, trajectory.front().stamp_ns + 1, gap_ns));
  EXPECT_FALSE(pose_at(trajectory, trajectory.front().stamp_ns + 1, gap_ns - 1));
  EXPECT_FALSE(pose_at({}, 0, gap_ns));
}

}  // namespace
}  // namespace kinloop
