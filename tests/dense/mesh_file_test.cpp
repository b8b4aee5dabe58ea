#include "dense/files/mesh_file.hpp"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "dense/files/pcd.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
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

/// A texture in which each triangle of the square has a chart of its own.
MeshTexture square_texture() {
  MeshTexture texture;
  texture.image = cv::Mat(32, 64, CV_8UC3, cv::Scalar(20, 60, 200));
  texture.uvs = {{0.1F, 0.2F}, {0.4F, 0.2F}, {0.4F, 0.8F}, {0.6F, 0.2F}, {0.9F, 0.8F}, {0.6F, 0.8F}};
  texture.vertex_of_uv = {0, 1, 2, 0, 2, 3};
  texture.triangles = {{0, 1, 2}, {3, 4, 5}};
  return texture;
}

TEST(MeshFile, GltfHoldsItsTexture) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "m.glb", square(), square_texture());
  const std::string bytes = read_file(folder.path() / "m.glb");
  const auto json_bytes = value_at<uint32_t>(bytes, 12);
  const auto scene = nlohmann::json::parse(bytes.substr(20, json_bytes));
  const size_t body = 20 + json_bytes + 8;
  EXPECT_EQ(value_at<uint32_t>(bytes, 8), bytes.size());
  EXPECT_EQ(body + scene["buffers"][0]["byteLength"].get<size_t>(), bytes.size());
  const auto& attributes = scene["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_FALSE(attributes.contains("COLOR_0")) << "it would darken the texture";
  const auto view_of = [&](const nlohmann::json& accessor) {
    return scene["bufferViews"][scene["accessors"][accessor.get<size_t>()]["bufferView"].get<size_t>()];
  };
  const size_t uvs = body + view_of(attributes["TEXCOORD_0"])["byteOffset"].get<size_t>();
  EXPECT_EQ(value_at<float>(bytes, uvs + 4 * 8), 0.9F);  // fifth vertex, from the upper left as glTF has it
  EXPECT_EQ(value_at<float>(bytes, uvs + 4 * 8 + 4), 0.8F);
  const size_t points = body + view_of(attributes["POSITION"])["byteOffset"].get<size_t>();
  EXPECT_EQ(value_at<float>(bytes, points + 4 * 12), 1.0F);  // third vertex of the square
  for (const auto& view : scene["bufferViews"]) EXPECT_EQ(view["byteOffset"].get<size_t>() % 4, 0U);

  const auto& material = scene["materials"][0];
  EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  EXPECT_TRUE(material["extensions"].contains("KHR_materials_unlit"));
  EXPECT_EQ(scene["extensionsUsed"], (nlohmann::json{"KHR_materials_unlit"}));
  const auto& image = scene["bufferViews"][scene["images"][0]["bufferView"].get<size_t>()];
  const cv::Mat decoded = decode_jpeg(std::string_view(bytes).substr(body + image["byteOffset"].get<size_t>(),
                                                                     image["byteLength"].get<size_t>()));
  ASSERT_EQ(decoded.size(), cv::Size(64, 32));
  EXPECT_NEAR(decoded.at<cv::Vec3b>(5, 5)[2], 200, 3);
}

TEST(MeshFile, ObjNamesItsTexture) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "my room.obj", square(), square_texture());
  const std::string text = read_file(folder.path() / "my room.obj");
  EXPECT_THAT(text, HasSubstr("mtllib my room.mtl\nusemtl images\n"));
  EXPECT_THAT(text, HasSubstr("\nv 1.00000 0.00000 1.00000\n"));
  EXPECT_THAT(text, HasSubstr("\nvt 0.900000 0.200000\n"));  // from below
  EXPECT_THAT(text, HasSubstr("\nf 1/1/1 2/2/2 3/3/3\nf 1/4/1 3/5/3 4/6/4\n"));
  EXPECT_THAT(read_file(folder.path() / "my room.mtl"), HasSubstr("newmtl images\n"));
  EXPECT_THAT(read_file(folder.path() / "my room.mtl"), HasSubstr("map_Kd my room.jpg\n"));
  EXPECT_EQ(decode_jpeg(read_file(folder.path() / "my room.jpg")).size(), cv::Size(64, 32));
}

TEST(MeshFile, NamesOfTexturesAreEscapedForTheFormat) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "a@@@b@.usda", square(), square_texture());
  EXPECT_THAT(read_file(folder.path() / "a@@@b@.usda"),
              HasSubstr("asset inputs:file = @@@./a\\@@@b@.jpg@@@\n"));
  for (const char* name : {"a\nmap_Kd b.obj", "a\nb.usda", "a\tb.obj"}) {
    EXPECT_THAT(test::input_error([&] { write_mesh(folder.path() / name, square(), square_texture()); }),
                HasSubstr("control characters"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / name));
  }
  EXPECT_NO_THROW(write_mesh(folder.path() / "a\nb.glb", square(), square_texture()));
}

TEST(MeshFile, UsdHoldsColoursOrNamesItsTexture) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "m.usda", square());
  std::string text = read_file(folder.path() / "m.usda");
  EXPECT_THAT(text, StartsWith("#usda 1.0\n"));
  EXPECT_THAT(text, HasSubstr("upAxis = \"Y\""));
  EXPECT_THAT(text, HasSubstr("xformOp:rotateX = 180"));
  EXPECT_THAT(text, HasSubstr("int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]\n"));
  EXPECT_THAT(text, HasSubstr("displayColor = [(1.0000, 0.0000, 0.0000), "));
  write_mesh(folder.path() / "t.usda", square(), square_texture(), z_up_frame({0, -1, 0}, {}));
  text = read_file(folder.path() / "t.usda");
  EXPECT_THAT(text, HasSubstr("upAxis = \"Z\""));
  EXPECT_THAT(text, HasSubstr("asset inputs:file = @./t.jpg@"));
  EXPECT_THAT(text, HasSubstr("primvars:st:indices = [0, 1, 2, 3, 4, 5]\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("displayColor")));
  EXPECT_EQ(std::count(text.begin(), text.end(), '{'), std::count(text.begin(), text.end(), '}'));
  EXPECT_EQ(decode_jpeg(read_file(folder.path() / "t.jpg")).size(), cv::Size(64, 32));
}

/// The offset of the bytes of each file in a ZIP archive, by name, as its directory at the end lists them.
std::map<std::string, size_t> files_in_zip(const std::string& zip) {
  std::map<std::string, size_t> found;
  const size_t end = zip.rfind("PK\5\6");
  const auto count = value_at<uint16_t>(zip, end + 10);
  size_t at = value_at<uint32_t>(zip, end + 16);
  for (int i = 0; i < count; ++i) {
    const auto name_bytes = value_at<uint16_t>(zip, at + 28);
    const size_t header = value_at<uint32_t>(zip, at + 42);
    EXPECT_EQ(zip.substr(header, 4), "PK\3\4");
    EXPECT_EQ(value_at<uint16_t>(zip, header + 8), 0) << "not compressed";
    found[zip.substr(at + 46, name_bytes)] =
        header + 30 + value_at<uint16_t>(zip, header + 26) + value_at<uint16_t>(zip, header + 28);
    at += 46U + name_bytes;
  }
  return found;
}

TEST(MeshFile, UsdzHoldsSceneAndTextureAligned) {
  const test::TempFolder folder;
  write_mesh(folder.path() / "t.usdz", square(), square_texture());
  const std::string zip = read_file(folder.path() / "t.usdz");
  const auto files = files_in_zip(zip);
  ASSERT_EQ(files.size(), 2U);
  for (const auto& [name, offset] : files) EXPECT_EQ(offset % 64, 0U) << name;
  EXPECT_LT(files.at("scene.usda"), files.at("texture.jpg")) << "the scene is the first";
  EXPECT_EQ(zip.substr(files.at("scene.usda"), 10), "#usda 1.0\n");
  EXPECT_THAT(zip, HasSubstr("asset inputs:file = @./texture.jpg@"));
  EXPECT_EQ(decode_jpeg(zip.substr(files.at("texture.jpg"))).size(), cv::Size(64, 32));
  write_mesh(folder.path() / "m.usdz", square());
  EXPECT_EQ(files_in_zip(read_file(folder.path() / "m.usdz")).size(), 1U);
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
