#include "kinloop/output/mesh_file.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/output/byte_stream.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

std::string ply_bytes(const ColoredMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment kinloop\nelement vertex {}\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      mesh.points.size(), mesh.triangles.size());
  for (size_t i = 0; i < mesh.points.size(); ++i) {
    put_values(bytes, mesh.points[i].data(), 3);
    put_values(bytes, mesh.colors[i].data(), 3);
  }
  constexpr uint8_t kCorners = 3;
  for (const Triangle& triangle : mesh.triangles) {
    put_values(bytes, &kCorners, 1);
    put_values(bytes, triangle.data(), 3);
  }
  return bytes;
}

std::string obj_text(const ColoredMesh& mesh) {
  constexpr double kFull = 255;
  std::string text = "# kinloop: vertices x y z red green blue\n";
  for (size_t i = 0; i < mesh.points.size(); ++i) {
    const auto& [red, green, blue] = mesh.colors[i];
    const Eigen::Vector3f& p = mesh.points[i];
    fmt::format_to(std::back_inserter(text), "v {:.5f} {:.5f} {:.5f} {:.3f} {:.3f} {:.3f}\n", p.x(), p.y(),
                   p.z(), red / kFull, green / kFull, blue / kFull);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", a + 1, b + 1, c + 1);
  }
  return text;
}

// Numbers of the glTF 2.0 specification.
constexpr int kUnsignedByte = 5121, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;

/// The part of the buffer from `begin` to its end so far.
json buffer_view(const std::string& buffer, size_t begin, int target) {
  return {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", buffer.size() - begin}, {"target", target}};
}

/// Least and greatest coordinates, which glTF asks for.
std::pair<json, json> bounds(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const auto& point : points) box.extend(point);
  const auto list = [](const Eigen::Vector3f& p) { return json{p.x(), p.y(), p.z()}; };
  return {list(box.min()), list(box.max())};
}

/// glTF's colours are light, not pixel values (the sRGB curve, IEC 61966-2-1).
uint8_t linear(uint8_t pixel) {
  constexpr double kFull = 255;
  const double s = pixel / kFull;
  const double light = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<uint8_t>(std::lround(kFull * light));
}

/// The world's y points down in kinloop (the first camera's), up in glTF: half a turn about x.
constexpr std::array<double, 4> kHalfTurnAboutX = {1, 0, 0, 0};

std::string glb_bytes(const ColoredMesh& mesh) {
  std::string buffer;
  json views = json::array();
  for (const auto& point : mesh.points) put_values(buffer, point.data(), 3);
  views.push_back(buffer_view(buffer, 0, kArrayBuffer));
  const size_t colors = buffer.size();
  for (const auto& [red, green, blue] : mesh.colors) {
    const uint8_t rgba[] = {linear(red), linear(green), linear(blue), 255};
    put_values(buffer, rgba, 4);
  }
  views.push_back(buffer_view(buffer, colors, kArrayBuffer));
  const size_t indices = buffer.size();
  for (const Triangle& triangle : mesh.triangles) put_values(buffer, triangle.data(), 3);
  views.push_back(buffer_view(buffer, indices, kElementArrayBuffer));

  const auto [low, high] = bounds(mesh.points);
  json accessors = {{{"bufferView", 0},
                     {"componentType", kFloat},
                     {"type", "VEC3"},
                     {"count", mesh.points.size()},
                     {"min", low},
                     {"max", high}},
                    {{"bufferView", 1},
                     {"componentType", kUnsignedByte},
                     {"type", "VEC4"},
                     {"normalized", true},
                     {"count", mesh.points.size()}},
                    {{"bufferView", 2},
                     {"componentType", kUnsignedInt},
                     {"type", "SCALAR"},
                     {"count", 3 * mesh.triangles.size()}}};
  const json primitive = {{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"indices", 2}, {"material", 0}};
  const json scene = {
      {"asset", {{"version", "2.0"}, {"generator", "kinloop"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"rotation", kHalfTurnAboutX}}}},
      {"meshes", {{{"primitives", {primitive}}}}},
      {"materials",
       {{{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}}}},
      {"buffers", {{{"byteLength", buffer.size()}}}},
      {"bufferViews", views},
      {"accessors", accessors}};
  std::string text = scene.dump();
  text.append((4 - text.size() % 4) % 4, ' ');

  std::string bytes = "glTF";
  const auto put = [&](size_t number) {
    const auto value = static_cast<uint32_t>(number);
    put_values(bytes, &value, 1);
  };
  constexpr size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
  put(2);
  put(kHeaderBytes + kChunkHeaderBytes + text.size() + kChunkHeaderBytes + buffer.size());
  put(text.size());
  bytes += "JSON" + text;
  put(buffer.size());
  bytes += std::string("BIN\0", 4) + buffer;
  return bytes;
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& path) {
  const auto form = path.extension();
  return form == ".ply" || form == ".obj" || form == ".glb";
}

void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh) {
  require(mesh.points.size() == mesh.colors.size(), "write_mesh: one colour per vertex");
  require(is_mesh_file(path), "write_mesh: .ply, .obj or .glb");
  if (path.extension() == ".ply") return write_file(path, ply_bytes(mesh));
  if (path.extension() == ".obj") return write_file(path, obj_text(mesh));
  write_file(path, glb_bytes(mesh));
}

}  // namespace kinloop
