#include "session/store/run_files.hpp"

#include <sstream>

#include <gmock/gmock.h>

#include "dense/files/ply.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

RunFiles some_files() {
  RunFiles files;
  for (int i = 0; i < 5; ++i) {
    files.trajectory.push_back({i * 1'000'000'000LL, {Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}}});
  }
  files.covariances.assign(5, Matrix6d::Identity());
  files.covariances[1] = std::nullopt;
  files.keyframes = {files.trajectory[0], files.trajectory[3]};
  files.ground_truth = files.trajectory;
  files.map.points.emplace_back(1, 2, 3);
  files.map.colors.push_back({1, 2, 3});
  files.metrics = {{"frames", 5}};
  return files;
}

TEST(RunFolder, OpeningAnExistingRunWritesNothing) {
  const test::TempFolder temp;
  const auto folder = RunFolder::open_existing(temp.path() / "none");
  EXPECT_EQ(folder.trajectory(), temp.path() / "none" / "trajectory.txt");
  EXPECT_FALSE(std::filesystem::exists(folder.path()));
}

TEST(RunFolder, HoldsEverythingUnderItsName) {
  const test::TempFolder temp;
  const RunFolder folder(temp.path() / "deep" / "out");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  write_run_files(folder, some_files());
  EXPECT_EQ(read_tum_trajectory(temp.path() / "deep/out/trajectory.txt").size(), 5U);
  EXPECT_EQ(read_tum_trajectory(temp.path() / "deep/out/keyframes.txt").size(), 2U);
  EXPECT_EQ(read_tum_trajectory(temp.path() / "deep/out/groundtruth.txt").size(), 5U);
  EXPECT_EQ(read_ply(temp.path() / "deep/out/map.ply").size(), 1U);
  EXPECT_EQ(read_run_json(temp.path() / "deep/out/run.json").at("frames"), 5);
}

TEST(RunFolder, CovariancesHaveALinePerPose) {
  const test::TempFolder temp;
  const RunFolder folder(temp.path());
  RunFiles files = some_files();
  files.covariances[2]->diagonal() << 1, 2, 3, 4, 5, 6;
  (*files.covariances[2])(0, 1) = (*files.covariances[2])(1, 0) = -0.125;
  write_run_files(folder, files);
  std::istringstream lines(read_file(folder.covariances()));
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(line);
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_THAT(rows[0], AllOf(testing::StartsWith("# stamp_s"), HasSubstr("axes of the camera")));
  std::string unknown = "1.000000";
  for (int i = 0; i < 21; ++i) unknown += " nan";
  EXPECT_EQ(rows[2], unknown);
  EXPECT_EQ(rows[3], "2.000000 1 -0.125 0 0 0 0 2 0 0 0 0 3 0 0 0 4 0 0 5 0 6");
  files.covariances.pop_back();
  EXPECT_THROW(write_run_files(folder, files), std::logic_error);
}

TEST(RunFolder, TheTrajectoryBeginsWithItsNote) {
  const test::TempFolder temp;
  const RunFolder folder(temp.path());
  auto files = some_files();
  files.note = "2 doubtful poses left out";
  write_run_files(folder, files);
  EXPECT_TRUE(read_file(folder.trajectory()).starts_with("# 2 doubtful poses left out\n"));
  EXPECT_EQ(read_tum_trajectory(folder.trajectory()).size(), 5U);
}

TEST(RunFolder, AnOlderRunsGroundTruthDoesNotStay) {
  const test::TempFolder temp;
  const RunFolder folder(temp.path());
  auto files = some_files();
  write_run_files(folder, files);
  files.ground_truth.clear();
  write_run_files(folder, files);
  EXPECT_FALSE(std::filesystem::exists(folder.ground_truth()));
}

TEST(RunFolder, ForeignFilesAreKept) {
  const test::TempFolder temp;
  temp.write("groundtruth.txt", "measured by somebody");
  auto files = some_files();
  files.ground_truth.clear();
  write_run_files(RunFolder(temp.path()), files);
  EXPECT_EQ(read_file(temp.path() / "groundtruth.txt"), "measured by somebody");
  temp.write("associations.txt", "");
  EXPECT_THAT(test::input_error([&] { const RunFolder folder(temp.path()); }), HasSubstr("holds a sequence"));
}

TEST(RunFolder, AFileInItsPlaceIsAnError) {
  const test::TempFolder temp;
  temp.write("out", "a file");
  EXPECT_THAT(test::input_error([&] { const RunFolder folder(temp.path() / "out"); }),
              HasSubstr("cannot create the folder"));
  EXPECT_THAT(test::input_error([&] { const RunFolder folder(temp.path() / "out" / "deeper"); }),
              HasSubstr("choose another output folder"));
}

TEST(RunFolder, AFolderThatCannotBeWrittenToIsAnErrorAtOnce) {
  // Root may write anywhere except in the kernel's file systems.
  for (const char* path : {"/proc", "/proc/kinloop"}) {
    if (!std::filesystem::exists("/proc")) GTEST_SKIP() << "no /proc here";
    EXPECT_THAT(test::input_error([&] { const RunFolder folder(path); }),
                HasSubstr("choose another output folder"))
        << path;
  }
}

TEST(RunFolder, FiguresThatAreNotJsonAreAnError) {
  const test::TempFolder temp;
  const auto path = temp.write("run.json", "{\"frames\": 5");
  EXPECT_THAT(test::input_error([&] { read_run_json(path); }), HasSubstr("run.json: not a JSON object"));
}

TEST(RunFolder, ReadsTheTimingsOfVersion01) {
  const test::TempFolder temp;
  const auto path = temp.write("run.json", R"({"rooms": {"tracking": {"cpu_s": 2}}})");
  EXPECT_EQ(read_run_json(path).at("timings").at("tracking").at("cpu_s"), 2);
}

}  // namespace
}  // namespace kinloop
