#include "dense/files/ply.hpp"

#include <array>
#include <cstring>
#include <string>

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

ColoredCloud some_cloud(size_t count) {
  ColoredCloud cloud;
  for (size_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i);
    cloud.points.emplace_back(x, -0.5F * x, 1 / (x + 1));
    cloud.colors.push_back({static_cast<uint8_t>(i), static_cast<uint8_t>(255 - i % 256), 7});
  }
  return cloud;
}

TEST(Ply, ReadsBackWhatWasWritten) {
  const test::TempFolder folder;
  for (const size_t count : {0U, 1U, 4096U, 10001U}) {
    const auto cloud = some_cloud(count);
    write_ply(folder.path() / "map.ply", cloud);
    const auto again = read_ply(folder.path() / "map.ply");
    EXPECT_EQ(again.points, cloud.points);
    EXPECT_EQ(again.colors, cloud.colors);
  }
}

TEST(Ply, IsWhatTheFormatSays) {
  const test::TempFolder folder;
  ColoredCloud cloud;
  cloud.points.emplace_back(1, 2, -3);
  cloud.colors.push_back({10, 20, 30});
  write_ply(folder.path() / "map.ply", cloud);
  const std::string bytes = read_file(folder.path() / "map.ply");
  EXPECT_THAT(bytes, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(bytes, HasSubstr("\nelement vertex 1\nproperty float x\n"));
  const std::string vertex("\x00\x00\x80\x3f\x00\x00\x00\x40\x00\x00\x40\xc0\x0a\x14\x1e", 15);
  EXPECT_EQ(bytes.substr(bytes.find("end_header\n") + 11), vertex);
}

TEST(Ply, HoldsNormalsAndTheFrameItIsWrittenIn) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.ply";
  ColoredCloud cloud = some_cloud(3);
  cloud.normals = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  // The first camera's y points down: up is -y, and it looks along z.
  const FileFrame frame = z_up_frame({0, -1, 0}, {});
  write_ply(path, cloud, frame);
  const std::string bytes = read_file(path);
  EXPECT_THAT(bytes,
              HasSubstr("property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"));
  const size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 3 * (24 + 3));
  std::array<float, 6> second{};
  std::memcpy(second.data(), bytes.data() + body + 27, sizeof second);
  const std::array<float, 6> expected{1, 0.5, 0.5, 0, 0, 1};  // x right, y ahead, z up
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(second[i], expected[i], 1e-6) << i;

  const ColoredCloud again = read_ply(path);
  for (size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LT((again.points[i] - cloud.points[i]).norm(), 1e-6);
    EXPECT_LT((again.normals[i] - cloud.normals[i]).norm(), 1e-6);
  }
  EXPECT_EQ(again.colors, cloud.colors);
  EXPECT_TRUE(read_ply_frame(path).z_up);
  EXPECT_LT(read_ply_frame(path).R_file_world.angularDistance(frame.R_file_world), 1e-12);
  write_ply(path, cloud);
  EXPECT_EQ(read_ply(path).normals, cloud.normals);
  EXPECT_FALSE(read_ply_frame(path).z_up);
}

TEST(Ply, ReadsFilesOfEarlierVersions) {
  const test::TempFolder folder;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment kinloop\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "end_header\n";
  bytes += std::string("\x00\x00\x80\x3f\x00\x00\x00\x40\x00\x00\x40\xc0\x0a\x14\x1e", 15);
  const auto cloud = read_ply(folder.write("map.ply", bytes));
  ASSERT_EQ(cloud.size(), 1U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1, 2, -3));
  EXPECT_TRUE(cloud.normals.empty());
}

TEST(Ply, SaysWhatIsWrongWithAFile) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.ply";
  EXPECT_THAT(test::input_error([&] { read_ply(path); }), HasSubstr("no such file"));
  folder.write("map.ply", "ply\nformat ascii 1.0\n");
  EXPECT_THAT(test::input_error([&] { read_ply(path); }), HasSubstr("map.ply: not a binary PLY"));
  write_ply(path, some_cloud(100));
  const std::string bytes = read_file(path);
  folder.write("map.ply", bytes.substr(0, bytes.size() - 1));
  EXPECT_THAT(test::input_error([&] { read_ply(path); }), HasSubstr("truncated"));
  std::string huge = bytes;
  huge.replace(huge.find("vertex 100"), 10, "vertex 99999999999999999999999");
  folder.write("map.ply", huge);
  EXPECT_THAT(test::input_error([&] { read_ply(path); }), HasSubstr("not a number"));
}

TEST(Ply, ARotationIsAUnitQuaternion) {
  EXPECT_FALSE(parse_frame_comments({"rotation_xyzw 1e200 0 0 1e200"}).z_up);
  EXPECT_FALSE(parse_frame_comments({"rotation_xyzw 0 0 0 2"}).z_up);
  EXPECT_FALSE(parse_frame_comments({"rotation_xyzw 0 0 0 0"}).z_up);
  EXPECT_TRUE(parse_frame_comments({"rotation_xyzw 0 0.6 0 0.8"}).z_up);
}

TEST(Ply, RefusesPointsThatAreNotFinite) {
  const test::TempFolder folder;
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    ColoredCloud cloud = some_cloud(3);
    cloud.points[1].y() = value;
    write_ply(folder.path() / "map.ply", cloud);
    EXPECT_THAT(test::input_error([&] { read_ply(folder.path() / "map.ply"); }),
                HasSubstr("map.ply: a coordinate is not a finite number"));
  }
}

TEST(Ply, AFullDiskIsAnErrorThatNamesTheFile) {
  const test::TempFolder folder;
  const auto message = test::on_a_full_disk(
      [&] { return test::input_error([&] { write_ply(folder.path() / "map.ply", some_cloud(20000)); }); });
  EXPECT_THAT(message, HasSubstr("map.ply: writing failed; is the disk full?"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace kinloop
