#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/export/trajectory_writer.hpp"

namespace kinloop {
namespace {

std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream text(read_file(path));
  for (std::string line; std::getline(text, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(PathCsv, HasOneLinePerFinitePoseWithTheExactStamp) {
  const test::TempFolder folder;
  Vector6d twist;
  twist << 1, -2, 3, 0.1, 0.2, -0.3;
  const SE3 T = SE3::exp(twist);
  SE3 unknown;
  unknown.translation.x() = std::numeric_limits<double>::quiet_NaN();
  write_path_csv(folder.path() / "p.csv", {{1305031910765238007, T}, {1305031911000000000, unknown}},
                 "world");
  const auto rows = read_csv(folder.path() / "p.csv");
  ASSERT_EQ(rows.size(), 2U);
  ASSERT_EQ(rows[0].size(), rows[1].size());
  const auto cell = [&](const std::string& name) {
    for (size_t i = 0; i < rows[0].size(); ++i) {
      if (rows[0][i] == name) return rows[1][i];
    }
    ADD_FAILURE() << "no field " << name;
    return std::string();
  };
  EXPECT_EQ(cell("header.stamp.sec"), "1305031910");
  EXPECT_EQ(cell("header.stamp.nanosec"), "765238007");
  EXPECT_EQ(cell("header.frame_id"), "world");
  EXPECT_NEAR(std::stod(cell("pose.position.y")), T.translation.y(), 1e-9);
  EXPECT_NEAR(std::stod(cell("pose.orientation.x")), T.rotation.x(), 1e-9);
  EXPECT_NEAR(std::stod(cell("pose.orientation.w")), T.rotation.w(), 1e-9);
}

TEST(PathCsv, StampsBeforeZeroAreRoundedDown) {
  const test::TempFolder folder;
  write_path_csv(folder.path() / "p.csv", {{-250'000'000, SE3()}}, "world");
  const auto rows = read_csv(folder.path() / "p.csv");
  EXPECT_EQ(rows.at(1).at(0), "-1");
  EXPECT_EQ(rows.at(1).at(1), "750000000");
}

TEST(PathCsv, AnEmptyTrajectoryHasOnlyTheFieldNames) {
  const test::TempFolder folder;
  write_path_csv(folder.path() / "p.csv", {}, "world");
  EXPECT_EQ(read_csv(folder.path() / "p.csv").size(), 1U);
}

}  // namespace
}  // namespace kinloop
