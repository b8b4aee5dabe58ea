#include "kinloop/io/mesh_file.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/io/point_cloud/pcd.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/support/value_at.hpp"

namespace kinloop {
namespace {

using test::value_at;
using testing::HasSubstr;
using testing::StartsWith;

ColoredMesh square() {
  ColoredMesh mesh;
  mesh.points = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  mesh.colors = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {0, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(MeshFile, PlyHoldsVerticesAndFaces) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "m.ply", square());
  const std::string bytes = read_file(folder.path() / "m.ply");
  EXPECT_THAT(bytes, HasSubstr("element vertex 4\n"));
  EXPECT_THAT(bytes, HasSubstr("element face 2\n"));
  const size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 4 * 27 + 2 * 13);
  EXPECT_EQ(value_at<uint8_t>(bytes, body + 4 * 27), 3);
  EXPECT_EQ(value_at<uint32_t>(bytes, body + 4 * 27 + 9), 2U);
}

TEST(MeshFile, ObjCountsFromOne) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "m.obj", square());
  const std::string text = read_file(folder.path() / "m.obj");
  EXPECT_THAT(text, HasSubstr("v 1.00000 0.00000 1.00000 0.000 1.000 0.000\n"));
  EXPECT_THAT(text, HasSubstr("\nvn 0.000 0.000 1.000\nf 1//1 2//2 3//3\nf 1//1 3//3 4//4\n"));
}

TEST(MeshFile, StlHoldsEachTriangleWithItsNormal) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "m.stl", square());
  const std::string bytes = read_file(folder.path() / "m.stl");
  constexpr size_t kHeader = 80, kTriangle = 50;
  ASSERT_EQ(bytes.size(), kHeader + 4 + 2 * kTriangle);
  EXPECT_THAT(bytes, testing::Not(StartsWith("solid")));  // which would be text
  EXPECT_EQ(value_at<uint32_t>(bytes, kHeader), 2U);
  const auto number = [&](size_t i) { return value_at<float>(bytes, kHeader + 4 + kTriangle + 4 * i); };
  const std::vector<float> second = {0, 0, 1, /* normal */ 0, 0, 1, 1, 1, 1, 0, 1, 1};
  for (size_t i = 0; i < second.size(); ++i) EXPECT_EQ(number(i), second[i]) << i;
}

TEST(MeshFile, GltfAddsUp) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "m.glb", square());
  const std::string bytes = read_file(folder.path() / "m.glb");
  EXPECT_THAT(bytes, StartsWith("glTF"));
  EXPECT_EQ(value_at<uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(value_at<uint32_t>(bytes, 8), bytes.size());
  const auto json_bytes = value_at<uint32_t>(bytes, 12);
  EXPECT_EQ(json_bytes % 4, 0U);
  const auto scene = nlohmann::json::parse(bytes.substr(20, json_bytes));
  const size_t body = 20 + json_bytes + 8;
  EXPECT_EQ(scene["buffers"][0]["byteLength"], bytes.size() - body);
  const auto accessor = [&](const char* name) {
    return scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"][name].get<size_t>()];
  };
  EXPECT_EQ(accessor("POSITION")["count"], 4);
  EXPECT_EQ(accessor("POSITION")["max"], (nlohmann::json{1, 1, 1}));
  EXPECT_EQ(accessor("COLOR_0")["normalized"], true);
  EXPECT_EQ(accessor("COLOR_0")["componentType"], 5123);  // unsigned short
  EXPECT_EQ(accessor("NORMAL")["count"], 4);
  const size_t normals = scene["bufferViews"][3]["byteOffset"].get<size_t>();
  EXPECT_EQ(value_at<float>(bytes, body + normals + 8), 1);
  const size_t indices = scene["bufferViews"][2]["byteOffset"].get<size_t>();
  EXPECT_EQ(value_at<uint32_t>(bytes, body + indices + 5 * 4), 3U);
}

TEST(MeshFile, DarkColorsOfGltfStayDifferent) {
  const test::TempFolder folder;
  ColoredMesh mesh = square();
  mesh.colors = {{1, 2, 3}, {4, 5, 6}, {255, 0, 0}, {0, 0, 0}};
  write_mesh(folder.path() / "m.glb", mesh);
  const std::string bytes = read_file(folder.path() / "m.glb");
  const auto json_bytes = value_at<uint32_t>(bytes, 12);
  const auto scene = nlohmann::json::parse(bytes.substr(20, json_bytes));
  const size_t colors = 20 + json_bytes + 8 + scene["bufferViews"][1]["byteOffset"].get<size_t>();
  // 65535 / (255 * 12.92) = 19.89 for each step.
  EXPECT_EQ(value_at<uint16_t>(bytes, colors), 20U);
  EXPECT_EQ(value_at<uint16_t>(bytes, colors + 2), 40U);
  EXPECT_EQ(value_at<uint16_t>(bytes, colors + 4), 60U);
  EXPECT_EQ(value_at<uint16_t>(bytes, colors + 6), 65535U);
  EXPECT_EQ(value_at<uint16_t>(bytes, colors + 2 * 8), 65535U);
}

/// The rotation of the node in a .glb.
Eigen::Quaterniond node_rotation(const std::string& bytes) {
  const auto scene = nlohmann::json::parse(bytes.substr(20, value_at<uint32_t>(bytes, 12)));
  const auto& q = scene["nodes"][0]["rotation"];
  return {q[3].get<double>(), q[0].get<double>(), q[1].get<double>(), q[2].get<double>()};
}

TEST(MeshFile, WhatIsUpIsAlongZAndInGltfAlongY) {
  const test::TempFolder folder;
  const auto path = folder.path() / "m.glb";
  const Eigen::Vector3d up(0.6, -0.8, 0);
  const FileFrame frame = z_up_frame(up, {});
  write_mesh(path, square(), frame);
  const Eigen::Vector3d shown = node_rotation(read_file(path)) * (frame.R_file_world * up);
  EXPECT_LT((shown - Eigen::Vector3d::UnitY()).norm(), 1e-9);
  write_mesh(path, square());
  const Eigen::Vector3d camera_up = node_rotation(read_file(path)) * Eigen::Vector3d(0, -1, 0);
  EXPECT_LT((camera_up - Eigen::Vector3d::UnitY()).norm(), 1e-9);

  write_mesh(folder.path() / "m.ply", square(), frame);
  const std::string bytes = read_file(folder.path() / "m.ply");
  EXPECT_THAT(bytes, HasSubstr("comment frame z-up"));
  const size_t vertex = bytes.find("end_header\n") + 11 + 27;  // (1, 0, 1) in the world
  EXPECT_NEAR(value_at<float>(bytes, vertex + 8), 0.6, 1e-6);
}

TEST(Pcd, IsWhatTheFormatSays) {
  const test::TempFolder folder;
  write_pcd(folder.path() / "c.pcd", {{{1, 2, -3}}, {{10, 20, 30}}});
  const std::string bytes = read_file(folder.path() / "c.pcd");
  EXPECT_THAT(bytes, HasSubstr("FIELDS x y z rgb\nSIZE 4 4 4 4\n"));
  EXPECT_THAT(bytes, HasSubstr("POINTS 1\nDATA binary\n"));
  EXPECT_EQ(value_at<float>(bytes, bytes.size() - 8), -3);
  EXPECT_EQ(value_at<uint32_t>(bytes, bytes.size() - 4), 0x0a141eU);
}

TEST(Pcd, HoldsNormalsAndIsUpright) {
  const test::TempFolder folder;
  write_pcd(folder.path() / "c.pcd", {{{1, 2, -3}}, {{10, 20, 30}}, {{0, -1, 0}}},
            z_up_frame({0, -1, 0}, {}));
  const std::string bytes = read_file(folder.path() / "c.pcd");
  EXPECT_THAT(bytes, HasSubstr("FIELDS x y z rgb normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4 4\n"
                               "TYPE F F F U F F F\nCOUNT 1 1 1 1 1 1 1\n"));
  EXPECT_THAT(bytes, HasSubstr("# frame z-up"));
  EXPECT_NEAR(value_at<float>(bytes, bytes.size() - 20), -2, 1e-6);
  EXPECT_NEAR(value_at<float>(bytes, bytes.size() - 4), 1, 1e-6);
}

}  // namespace
}  // namespace kinloop
