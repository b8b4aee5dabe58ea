#include "tools/export/las.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/support/value_at.hpp"

namespace kinloop {
namespace {

using test::value_at;
using testing::HasSubstr;

/// A file as read by the specification of LAS 1.2.
struct ReadLas {
  std::string bytes;
  uint32_t count = 0;
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<uint16_t, 3>> colors;
  Eigen::Vector3d low, high;
};

ReadLas read_las(const std::filesystem::path& path) {
  ReadLas las;
  const std::string& bytes = las.bytes = read_file(path);
  EXPECT_EQ(bytes.substr(0, 4), "LASF");
  EXPECT_EQ(bytes[24], 1);
  EXPECT_EQ(bytes[25], 2);
  EXPECT_EQ(value_at<uint16_t>(bytes, 94), 227);
  const auto begin = value_at<uint32_t>(bytes, 96);
  EXPECT_EQ(bytes[104], 2) << "point format";
  const auto stride = value_at<uint16_t>(bytes, 105);
  EXPECT_EQ(stride, 26);
  las.count = value_at<uint32_t>(bytes, 107);
  EXPECT_EQ(value_at<uint32_t>(bytes, 111), las.count) << "points of the first return";
  EXPECT_EQ(bytes.size(), begin + size_t{26} * las.count);
  for (int axis = 0; axis < 3; ++axis) {
    las.high[axis] = value_at<double>(bytes, 179 + 16 * axis);
    las.low[axis] = value_at<double>(bytes, 187 + 16 * axis);
  }
  // The records end where the points begin.
  EXPECT_EQ(value_at<uint32_t>(bytes, 100), 1U);
  EXPECT_EQ(227U + 54 + value_at<uint16_t>(bytes, 227 + 20), begin);
  for (uint32_t i = 0; i < las.count; ++i) {
    const size_t at = begin + size_t{26} * i;
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = value_at<int32_t>(bytes, at + 4 * axis) * value_at<double>(bytes, 131 + 8 * axis) +
                value_at<double>(bytes, 155 + 8 * axis);
    }
    EXPECT_EQ(bytes[at + 14], 0b001001) << "return 1 of 1";
    las.points.push_back(p);
    las.colors.push_back({value_at<uint16_t>(bytes, at + 20), value_at<uint16_t>(bytes, at + 22),
                          value_at<uint16_t>(bytes, at + 24)});
  }
  return las;
}

TEST(Las, HoldsPointsToTheScaleColorsAndBounds) {
  const test::TempFolder folder;
  const ColoredCloud cloud{{{1.23456F, -2, 3}, {-4.00004F, 5.5F, 0}, {0, 0, 0.00006F}},
                           {Rgb{255, 0, 128}, Rgb{1, 2, 3}, Rgb{0, 0, 0}}};
  const FileFrame frame = z_up_frame({0, -1, 0}, SE3());
  write_las(folder.path() / "c.las", cloud, frame);
  const ReadLas las = read_las(folder.path() / "c.las");
  ASSERT_EQ(las.count, 3U);
  Eigen::AlignedBox3d box;
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_LE((las.points[i] - frame.to_file(cloud.points[i]).cast<double>()).cwiseAbs().maxCoeff(),
              0.50001e-4);
    box.extend(las.points[i]);
  }
  EXPECT_LT((las.low - box.min()).norm() + (las.high - box.max()).norm(), 1e-12);
  EXPECT_EQ(las.colors[0], (std::array<uint16_t, 3>{65535, 0, 128 * 257}));
  EXPECT_THAT(las.bytes, HasSubstr("rotation_xyzw"));
}

TEST(Las, LeavesOutPointsThatAreNotFinite) {
  const test::TempFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  write_las(folder.path() / "c.las",
            {{{nan, 0, 0}, {1, 2, 3}, {0, 0, inf}}, {Rgb{1, 1, 1}, Rgb{2, 2, 2}, Rgb{3, 3, 3}}});
  const ReadLas las = read_las(folder.path() / "c.las");
  ASSERT_EQ(las.count, 1U);
  EXPECT_EQ(las.colors[0][0], 2 * 257);
}

TEST(Las, AnEmptyCloudHasZeroBounds) {
  const test::TempFolder folder;
  write_las(folder.path() / "c.las", {});
  const ReadLas las = read_las(folder.path() / "c.las");
  EXPECT_EQ(las.count, 0U);
  EXPECT_TRUE(las.low.isZero(0) && las.high.isZero(0));
}

TEST(Las, RefusesCoordinatesBeyondItsSteps) {
  const test::TempFolder folder;
  const auto path = folder.path() / "c.las";
  EXPECT_THAT(test::input_error([&] {
                write_las(path, {{{3e5F, 0, 0}}, {Rgb{}}});
              }),
              testing::AllOf(HasSubstr("c.las: "), HasSubstr("write .ply")));
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace kinloop
