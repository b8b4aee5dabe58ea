#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

#include <cmath>
#include <functional>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

constexpr int kFilePoses = 40;
constexpr int64_t kFileStart_ns = 1'403'636'579 * kNsPerSecond + 763'555'584;
constexpr int64_t kFilePeriod_ns = 50'000'000;

/// The i-th pose; `first_angle_rad` 0 makes the first one the identity.
SE3 pose(int i, double first_angle_rad = 0.4) {
  return {exp_so3({first_angle_rad + 0.01 * i, 0.02 * i, -0.01 * i}), {2 + 0.1 * i, -1, 0.05 * i}};
}

int64_t stamp_ns(int i) {
  return kFileStart_ns + i * kFilePeriod_ns;
}

/// Lines that `line(i)` returns for each pose.
std::string lines(const std::function<std::string(int)>& line) {
  std::string text;
  for (int i = 0; i < kFilePoses; ++i) text += line(i) + "\n";
  return text;
}

/// The pose as text: t, and q in the order of `order` (as "xyzw").
std::string pose_text(const SE3& T, const std::string& order = "xyzw", const char* separator = " ") {
  std::string text = fmt::format("{1:.9f}{0}{2:.9f}{0}{3:.9f}", separator, T.translation.x(),
                                 T.translation.y(), T.translation.z());
  for (const char axis : order) {
    const auto component = static_cast<Eigen::Index>(std::string("xyzw").find(axis));
    text += fmt::format("{}{:.9f}", separator, T.rotation.coeffs()[component]);
  }
  return text;
}

std::string tum_line(int i) {
  return format_stamp(stamp_ns(i)) + " " + pose_text(pose(i));
}

std::string matrix_line(const SE3& T) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 4; ++col) text += fmt::format("{:.9f} ", T.matrix()(row, col));
  }
  return text;
}

class TrajectoryFiles : public testing::Test {
 protected:
  TrajectoryFile read(const std::string& content, const std::string& name = "poses.txt") const {
    return read_trajectory_file(folder_.write(name, content));
  }

  std::string error_of(const std::string& content) const {
    try {
      read(content);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  static void expect_poses(const TrajectoryFile& file, double first_angle_rad = 0.4, int64_t within_ns = 0) {
    ASSERT_EQ(file.poses.size(), static_cast<size_t>(kFilePoses));
    for (int i = 0; i < kFilePoses; ++i) {
      const auto& found = file.poses[static_cast<size_t>(i)];
      EXPECT_LE(std::abs(found.stamp_ns - stamp_ns(i)), within_ns) << i;
      EXPECT_LT((found.T_world_camera.inverse() * pose(i, first_angle_rad)).log().norm(), 1e-7) << i;
    }
  }

  test::TempFolder folder_;
};

TEST_F(TrajectoryFiles, Tum) {
  const auto file = read("# a comment\n" + lines(tum_line));
  expect_poses(file);
  EXPECT_EQ(file.format, TrajectoryFormat::kTum);
  EXPECT_FALSE(file.knows_quaternion_order);
  EXPECT_THAT(file.notes, testing::IsEmpty());
}

TEST_F(TrajectoryFiles, TumOfNumpyInScientificNotation) {
  expect_poses(read(lines([](int i) {
                 return fmt::format("{:.18e} ", to_seconds(stamp_ns(i))) + pose_text(pose(i));
               })),
               0.4, 500);
}

TEST_F(TrajectoryFiles, TumWithCommasAndWindowsLineEnds) {
  expect_poses(read("\xEF\xBB\xBF" + lines([](int i) {
                      return format_stamp(stamp_ns(i)) + "," + pose_text(pose(i), "xyzw", ",") + "\r";
                    })));
}

TEST_F(TrajectoryFiles, TumInNanoseconds) {
  const auto file = read(lines([](int i) { return fmt::format("{} {}", stamp_ns(i), pose_text(pose(i))); }));
  expect_poses(file);
  EXPECT_THAT(file.notes, testing::ElementsAre("time stamps are taken as ns"));
}

TEST_F(TrajectoryFiles, StampsFromZeroInMillisecondsAndNanoseconds) {
  for (const auto& [unit_ns, name] : {std::pair{1'000'000, "ms"}, std::pair{1, "ns"}}) {
    const auto file = read(
        lines([&](int i) { return fmt::format("{} {}", i * kFilePeriod_ns / unit_ns, pose_text(pose(i))); }));
    EXPECT_EQ(file.poses[3].stamp_ns, 3 * kFilePeriod_ns) << name;
  }
}

TEST_F(TrajectoryFiles, QuaternionsBeforePositionsAreFoundByTheirNorm) {
  const auto file = read(lines([](int i) {
    const auto q = pose(i).rotation;
    const auto t = pose(i).translation;
    return fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", format_stamp(stamp_ns(i)),
                       q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z());
  }));
  expect_poses(file);
  EXPECT_THAT(file.notes, testing::ElementsAre("columns are taken as timestamp qx qy qz qw tx ty tz"));
}

TEST_F(TrajectoryFiles, WFirstIsFoundByAnIdentityOrByNames) {
  const auto line = [](double first_angle_rad) {
    return
        [=](int i) { return format_stamp(stamp_ns(i)) + " " + pose_text(pose(i, first_angle_rad), "wxyz"); };
  };
  const auto of_identity = read(lines(line(0)));
  expect_poses(of_identity, 0);
  EXPECT_TRUE(of_identity.knows_quaternion_order);
  EXPECT_THAT(of_identity.notes, testing::ElementsAre("columns are taken as timestamp tx ty tz qw qx qy qz"));
  expect_poses(read("# timestamp tx ty tz qw qx qy qz\n" + lines(line(0.4))));
}

TEST_F(TrajectoryFiles, Euroc) {
  const auto content = lines([](int i) {
    return fmt::format("{},{},0.1,0.2,0.3,0,0,0,0,0,0", stamp_ns(i), pose_text(pose(i), "wxyz", ","));
  });
  const auto without_header = read(content);
  expect_poses(without_header);
  EXPECT_EQ(without_header.format, TrajectoryFormat::kEuroc);
  expect_poses(
      read("#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
           "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], "
           "b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1]\n" +
           content));
}

TEST_F(TrajectoryFiles, OwnTable) {
  const auto file = read(
      "header.stamp.sec,header.stamp.nanosec,header.frame_id,pose.position.x,pose.position.y,"
      "pose.position.z,pose.orientation.x,pose.orientation.y,pose.orientation.z,"
      "pose.orientation.w\n" +
      lines([](int i) {
        const auto [s, ns] = split_stamp(stamp_ns(i));
        return fmt::format("{},{},world,{}", s, ns, pose_text(pose(i), "xyzw", ","));
      }));
  expect_poses(file);
  EXPECT_EQ(file.format, TrajectoryFormat::kCsv);
  EXPECT_TRUE(file.knows_quaternion_order);
}

TEST_F(TrajectoryFiles, KittiIsNumberedUnlessTimesLieBesideIt) {
  const auto content = lines([](int i) { return matrix_line(pose(i)); });
  const auto numbered = read(content);
  EXPECT_EQ(numbered.format, TrajectoryFormat::kKitti);
  EXPECT_FALSE(numbered.has_stamps);
  EXPECT_EQ(numbered.poses[7].stamp_ns, 7 * kNumberedStepNs);
  folder_.write("times.txt", "0.0\n0.1\n");  // of another sequence
  EXPECT_FALSE(read(content).has_stamps);
  folder_.write("times.txt", lines([](int i) { return format_stamp(stamp_ns(i)); }));
  const auto timed = read(content);
  EXPECT_TRUE(timed.has_stamps);
  expect_poses(timed);
  expect_poses(read(lines([](int i) { return matrix_line(pose(i)) + "0 0 0 1"; })));
}

TEST_F(TrajectoryFiles, SeveralTrajectoriesInOneFileAreAnError) {
  EXPECT_THAT(error_of(lines(tum_line) + lines(tum_line)),
              AllOf(HasSubstr("poses.txt:41: time goes back by 1.950 s"), HasSubstr("holds 2 trajectories")));
  EXPECT_THAT(error_of(lines(tum_line) + lines([](int i) {
                         return format_stamp(stamp_ns(i) + 7'000'000) + " " + pose_text(pose(i));
                       })),
              HasSubstr("holds 2 trajectories"));
}

TEST_F(TrajectoryFiles, LinesOutOfOrderAreSorted) {
  const auto file = read(lines([](int i) { return tum_line(kFilePoses - 1 - i); }));
  expect_poses(file);
  EXPECT_THAT(file.notes, testing::ElementsAre("lines are not in order of time, and were sorted"));
}

TEST_F(TrajectoryFiles, RepeatedStampsAreSaidOrAnError) {
  EXPECT_THAT(error_of(lines([](int i) { return "1403636579.7 " + pose_text(pose(i)); })),
              HasSubstr("39 of 40 time stamps repeat"));
  std::string many;
  for (int i = 0; i < 200; ++i)
    many += fmt::format("{:.2f} {}\n", 0.1 * (i == 1 ? 0 : i), pose_text(pose(i)));
  EXPECT_THAT(read(many).notes, testing::ElementsAre("one of 200 time stamps repeats"));
}

TEST_F(TrajectoryFiles, LinesOfNanAreNoPoses) {
  const auto nan_at = [&](int bad) {
    return lines([&](int i) {
      return i >= bad && i < bad + 3 ? fmt::format("{} NaN NaN NaN NaN NaN NaN NaN", 1403636580 + i)
                                     : tum_line(i);
    });
  };
  for (const int bad : {0, 5}) {
    const TrajectoryFile file = read(nan_at(bad));
    EXPECT_EQ(file.poses.size(), 37U);
    EXPECT_THAT(file.notes, testing::Contains(HasSubstr("3 lines of NaN")));
  }
  EXPECT_THAT(error_of("1403636580 nan nan nan nan nan nan nan\n"), HasSubstr("all poses are NaN"));
}

TEST_F(TrajectoryFiles, WhatIsNoPoseIsNamedByItsLine) {
  const auto two = [](const std::string& second) { return tum_line(0) + "\n" + second + "\n"; };
  EXPECT_THAT(error_of("1 2 3\n"), AllOf(HasSubstr("poses.txt:1"), HasSubstr("found 3 fields")));
  EXPECT_THAT(error_of(two("1 2 3")),
              AllOf(HasSubstr("poses.txt:2"), HasSubstr("3 fields where the first line has 8")));
  EXPECT_THAT(error_of(two("1403636580 1 2 inf 0 0 0 1")), HasSubstr("poses.txt:2: 'inf'"));
  EXPECT_THAT(error_of(two("1403636580 1 2 3 0 0 0 0")), HasSubstr("poses.txt:2: the quaternion is zero"));
  EXPECT_THAT(error_of(two("noon 1 2 3 0 0 0 1")), HasSubstr("poses.txt:2: 'noon' is not a time stamp"));
  EXPECT_THAT(error_of("1e300 1 2 3 0 0 0 1\n"), HasSubstr("not a possible time stamp"));
  EXPECT_THAT(error_of("1 1 1 0 0 1 0 0 0 0 1 0\n"), HasSubstr("poses.txt:1: the matrix is not a rotation"));
  EXPECT_THAT(error_of(""), HasSubstr("has no poses"));
  EXPECT_THAT(error_of("timestamp,tx\n"), HasSubstr("has no poses"));
  EXPECT_THAT(error_of(std::string("\x89PNG\0\0", 6)), HasSubstr("not a text file"));
}

TEST(SharedTrajectories, FaultsAreNamedAndRealTruthIsRead) {
  const auto folder = test::shared_data("faults/eval");
  KINLOOP_SKIP_WITHOUT(folder);
  EXPECT_THROW(read_trajectory_file(folder / "two.txt"), InputError);
  EXPECT_THROW(read_trajectory_file(folder / "gtwo.txt"), InputError);
  EXPECT_THROW(read_trajectory_file(folder / "eq.txt"), InputError);
  EXPECT_EQ(read_trajectory_file(folder / "few.txt").poses.size(), 27U);
  const auto truth = test::shared_data("trajectories") / "tum_groundtruth" / "fr2_xyz_partial.txt";
  EXPECT_THAT(read_trajectory_file(truth).notes, testing::IsEmpty()) << "8 of 36690 stamps repeat";
}

}  // namespace
}  // namespace kinloop
