#include "viewer/point_files/point_file.hpp"

#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "dense/files/mesh_file.hpp"
#include "dense/files/pcd.hpp"
#include "dense/files/ply.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "viewer/point_files/point_formats.hpp"

namespace kinloop {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// Consecutive numbers in either byte order.
class Binary {
 public:
  explicit Binary(std::endian order = std::endian::little) : order_(order) {}

  template <class T>
  Binary& put(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (order_ != std::endian::native) bytes = std::string(bytes.rbegin(), bytes.rend());
    bytes_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::endian order_;
  std::string bytes_;
};

class PointFileTest : public testing::Test {
 protected:
  PointFile ply(const std::string& bytes) { return read_any_ply(folder_.write("f.ply", bytes)); }
  PointFile pcd(const std::string& bytes) { return read_any_pcd(folder_.write("f.pcd", bytes)); }
  std::string ply_error(const std::string& bytes) {
    return test::input_error([&] { ply(bytes); });
  }
  std::string pcd_error(const std::string& bytes) {
    return test::input_error([&] { pcd(bytes); });
  }

  const test::TempFolder folder_;
};

TEST_F(PointFileTest, AsciiPlyWithPropertiesOfAnyTypeInAnyOrder) {
  const PointFile file = ply(
      "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement vertex 2\r\nproperty uchar blue\r\n"
      "property double z\r\nproperty float nx\r\nproperty int x\r\nproperty short y\r\nproperty uchar red\r\n"
      "property uchar green\r\nend_header\r\n3 0.5 1 10 -20 1 2\r\n6 1e-1 0 +7 8 4 5\r\n");
  EXPECT_THAT(file.mesh.points, ElementsAre(Eigen::Vector3f(10, -20, 0.5F), Eigen::Vector3f(7, 8, 0.1F)));
  EXPECT_THAT(file.mesh.colors, ElementsAre(Rgb{1, 2, 3}, Rgb{4, 5, 6}));
  EXPECT_THAT(file.comments, ElementsAre("made by hand"));
  EXPECT_TRUE(file.mesh.triangles.empty());
}

TEST_F(PointFileTest, BinaryPlyOfEitherByteOrderWithFacesAndOtherElements) {
  for (const auto order : {std::endian::little, std::endian::big}) {
    Binary body(order);
    body.put(uint8_t{2}).put(1.0F).put(2.0F);  // an unknown element with a list
    for (const double x : {0.0, 1.0, 2.0, 3.0}) body.put(x).put(-x).put(0.5).put(0.25F).put(1.0F).put(0.0F);
    body.put(uint8_t{4}).put(int32_t{0}).put(int32_t{1}).put(int32_t{2}).put(int32_t{3}).put(uint16_t{9});
    const PointFile file =
        ply(fmt::format("ply\nformat {} 1.0\nelement scan 1\nproperty list uchar float angles\n"
                        "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                        "property float red\nproperty float green\nproperty float blue\nelement face 1\n"
                        "property list uchar int vertex_index\nproperty ushort flags\nend_header\n",
                        order == std::endian::little ? "binary_little_endian" : "binary_big_endian") +
            body.bytes());
    ASSERT_EQ(file.mesh.points.size(), 4U);
    EXPECT_EQ(file.mesh.points[3], Eigen::Vector3f(3, -3, 0.5F));
    EXPECT_EQ(file.mesh.colors[0], (Rgb{64, 255, 0}));
    EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  }
}

TEST_F(PointFileTest, ReadsWhatKinloopWrites) {
  const ColoredMesh mesh{
      {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}}, {{255, 0, 1}, {0, 255, 2}, {3, 0, 255}}, {{0, 1, 2}}};
  write_mesh(folder_.path() / "mesh.ply", mesh);
  write_ply(folder_.path() / "cloud.ply", {mesh.points, mesh.colors});
  write_pcd(folder_.path() / "cloud.pcd", {mesh.points, mesh.colors});
  const PointFile files[] = {read_any_ply(folder_.path() / "mesh.ply"),
                             read_any_ply(folder_.path() / "cloud.ply"),
                             read_any_pcd(folder_.path() / "cloud.pcd")};
  for (const PointFile& file : files) {
    EXPECT_EQ(file.mesh.points, mesh.points);
    EXPECT_EQ(file.mesh.colors, mesh.colors);
  }
  EXPECT_EQ(files[0].mesh.triangles, mesh.triangles);
  EXPECT_THAT(files[0].comments, Contains("kinloop"));
}

TEST_F(PointFileTest, PointsThatAreNotFiniteAreLeftOutWithTheirFaces) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const PointFile file = ply(header + "nan 0 0\n1 0 0\n2 0 0\n3 0 0\n3 0 1 2\n3 1 2 3\n");
  EXPECT_EQ(file.mesh.points.size(), 3U);
  EXPECT_TRUE(file.mesh.colors.empty());
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
}

TEST_F(PointFileTest, LargeCoordinatesKeepTheirDetail) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double "
      "z\nend_header\n";
  const PointFile file = ply(header + "4500000.123 5300000 400\n4500000.125 5300000 400\n");
  EXPECT_NEAR(file.mesh.points[1].x() - file.mesh.points[0].x(), 0.002, 1e-6);
}

TEST_F(PointFileTest, DamagedPlyIsOneLineThatSaysWhatIsWrong) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\n";
  EXPECT_THAT(ply_error(""), HasSubstr("f.ply:1: not a PLY file"));
  EXPECT_THAT(ply_error("PK\x03\x04"), HasSubstr("not a PLY file"));
  EXPECT_THAT(ply_error(header), HasSubstr("without the line 'end_header'"));
  EXPECT_THAT(ply_error(header + "end_header\n" + std::string(23, 'x')), HasSubstr("truncated"));
  EXPECT_THAT(ply_error("ply\nformat binary 1.0\nend_header\n"), HasSubstr("f.ply:2: format 'binary'"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex many\n"), HasSubstr("'many' is not a number"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n"),
              HasSubstr("f.ply:4: 'real' is not a PLY type"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement face 0\nend_header\n"), HasSubstr("no vertices"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n"),
              HasSubstr("lack x, y or z"));
  EXPECT_THAT(ply_error("ply\nformat \x1b[2J\xff 1.0\nend_header\n"), HasSubstr("format '?[2J?'"));
  std::string many = header;
  many.replace(many.find("vertex 2"), 8, "vertex 999999999999999");
  EXPECT_THAT(ply_error(many + "end_header\n0123456789"), HasSubstr("truncated"));
  std::string ascii = header;
  ascii.replace(ascii.find("binary_little_endian"), 20, "ascii");
  EXPECT_THAT(ply_error(ascii + "end_header\n1 2 3\n4 5\n"), HasSubstr("truncated"));
  EXPECT_THAT(ply_error(ascii + "end_header\n1 2 3\n4 five 6\n"), HasSubstr("'five' is not a number"));
  const std::string face =
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n4 5 6\n";
  EXPECT_THAT(ply_error(ascii + face + "3 0 1 2\n"), HasSubstr("refers to vertex 2 of 2"));
  EXPECT_THAT(ply_error(ascii + face + "3 0 1 -1\n"), HasSubstr("-1 is not a valid vertex index"));
  EXPECT_THAT(ply_error(ascii + "end_header\nnan 2 3\n4 inf 6\n"), HasSubstr("none of its 2 points"));
}

std::string pcd_header(const std::string& data, size_t points, const std::string& color_type = "F") {
  return fmt::format(
      "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS x _ y z rgb\nSIZE 4 1 8 4 4\n"
      "TYPE F U F F {}\nCOUNT 1 3 1 1 1\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      color_type, points, points, data);
}

/// x 1 2 3, y 4 5 6 (double), z 7 8 9; colours 10 20 30, and a float with the bits of a NaN.
constexpr std::array<uint32_t, 3> kColors = {0x0a141e, 0xff804020, 0x010203};

TEST_F(PointFileTest, BinaryPcdWithPaddingAndDoubles) {
  Binary body;
  for (size_t i = 0; i < 3; ++i) {
    body.put(static_cast<float>(1 + i)).put(uint8_t{9}).put(uint8_t{9}).put(uint8_t{9});
    body.put(static_cast<double>(4 + i)).put(static_cast<float>(7 + i)).put(kColors[i]);
  }
  const PointFile file = pcd(pcd_header("binary", 3) + body.bytes());
  EXPECT_THAT(file.mesh.points,
              ElementsAre(Eigen::Vector3f(1, 4, 7), Eigen::Vector3f(2, 5, 8), Eigen::Vector3f(3, 6, 9)));
  EXPECT_THAT(file.mesh.colors, ElementsAre(Rgb{10, 20, 30}, Rgb{128, 64, 32}, Rgb{1, 2, 3}));
  EXPECT_THAT(pcd_error(pcd_header("binary", 4) + body.bytes()), HasSubstr("3 of 4 points"));
}

TEST_F(PointFileTest, AsciiPcdWithColoursAsFloatsOrIntegers) {
  const std::string points = "1 0 0 0 4 7 {}\nnan 0 0 0 5 8 {}\n3 0 0 0 6 9 {}\n";
  const auto as_float = [](uint32_t bits) { return fmt::format("{}", std::bit_cast<float>(bits)); };
  const PointFile floats =
      pcd(pcd_header("ascii", 3) +
          fmt::format(fmt::runtime(points), as_float(kColors[0]), 0, as_float(kColors[2])));
  const PointFile integers =
      pcd(pcd_header("ascii", 3, "U") + fmt::format(fmt::runtime(points), kColors[0], 0, kColors[2]));
  for (const PointFile& file : {floats, integers}) {
    EXPECT_THAT(file.mesh.points, ElementsAre(Eigen::Vector3f(1, 4, 7), Eigen::Vector3f(3, 6, 9)));
    EXPECT_THAT(file.mesh.colors, ElementsAre(Rgb{10, 20, 30}, Rgb{1, 2, 3}));
  }
}

/// As liblzf, without searching for repetitions.
std::string literals(std::string_view bytes) {
  std::string packed;
  for (size_t at = 0; at < bytes.size(); at += 32) {
    const std::string_view run = bytes.substr(at, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  return packed;
}

TEST_F(PointFileTest, CompressedPcdHoldsOneFieldAfterTheOther) {
  Binary body;
  for (const float x : {1.0F, 2.0F, 3.0F}) body.put(x);
  for (int i = 0; i < 9; ++i) body.put(uint8_t{9});
  for (const double y : {4.0, 5.0, 6.0}) body.put(y);
  for (const float z : {7.0F, 8.0F, 9.0F}) body.put(z);
  for (const uint32_t color : kColors) body.put(color);
  const std::string packed = literals(body.bytes());
  Binary sizes;
  sizes.put(static_cast<uint32_t>(packed.size())).put(static_cast<uint32_t>(body.bytes().size()));
  const std::string whole = pcd_header("binary_compressed", 3) + sizes.bytes() + packed;
  const PointFile file = pcd(whole);
  EXPECT_THAT(file.mesh.points,
              ElementsAre(Eigen::Vector3f(1, 4, 7), Eigen::Vector3f(2, 5, 8), Eigen::Vector3f(3, 6, 9)));
  EXPECT_EQ(file.mesh.colors[1], (Rgb{128, 64, 32}));
  EXPECT_THAT(pcd_error(whole.substr(0, whole.size() - 1)), HasSubstr("truncated"));
  std::string damaged = whole;
  damaged[whole.size() - packed.size()] = '\xff';  // a reference to data that has not come yet
  EXPECT_THAT(pcd_error(damaged), HasSubstr("compressed part is damaged"));
}

TEST_F(PointFileTest, DamagedPcdIsOneLineThatSaysWhatIsWrong) {
  const auto edited = [](const std::string& from, const std::string& to) {
    std::string header = pcd_header("ascii", 1);
    return header.replace(header.find(from), from.size(), to) + "1 0 0 0 2 3 4\n";
  };
  EXPECT_THAT(pcd_error("\x89PNG"), HasSubstr("f.pcd: not a PCD file"));
  EXPECT_THAT(pcd_error(edited("DATA ascii", "DATA text")), HasSubstr("DATA text: expected ascii"));
  EXPECT_THAT(pcd_error(edited("TYPE F U", "TYPE Q U")), HasSubstr("TYPE Q with SIZE 4"));
  EXPECT_THAT(pcd_error(edited("FIELDS x _", "FIELDS x")), HasSubstr("SIZE and FIELDS differ"));
  EXPECT_THAT(pcd_error(edited("FIELDS x", "FIELDS u")), HasSubstr("lack x, y or z"));
  EXPECT_THAT(pcd_error(edited("POINTS 1", "POINTS -1")), HasSubstr("'-1'"));
  EXPECT_THAT(pcd_error(edited("POINTS 1", "POINTS 2")), HasSubstr("truncated: 1 of 2"));
}

TEST(Lzf, RepeatsWhatWasThere) {
  const std::string packed(
      "\x02"
      "abc\xe0\x01\x02\x00"
      "d",
      9);  // abc, 7 + 1 + 2 bytes from distance 3, d
  EXPECT_EQ(decompress_lzf(packed, 14), "abcabcabcabcad");
  EXPECT_FALSE(decompress_lzf(packed, 13));
  EXPECT_FALSE(decompress_lzf(packed, 15));
  EXPECT_FALSE(decompress_lzf(std::string("\x20\x05", 2), 3));
  EXPECT_FALSE(decompress_lzf(packed, size_t{1} << 40));
}

}  // namespace
}  // namespace kinloop
