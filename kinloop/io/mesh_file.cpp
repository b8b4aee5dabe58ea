#include "kinloop/io/mesh_file.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/io/map_file/byte_stream.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

/// A mesh in the frame of its file.
struct FileMesh {
  const ColoredMesh& mesh;
  const FileFrame& frame;
  std::vector<Eigen::Vector3f> normals_world;

  [[nodiscard]] size_t size() const { return mesh.points.size(); }
  [[nodiscard]] Eigen::Vector3f point(size_t i) const { return frame.to_file(mesh.points[i]); }
  [[nodiscard]] Eigen::Vector3f normal(size_t i) const { return frame.to_file(normals_world[i]); }
};

std::string ply_bytes(const FileMesh& file) {
  const ColoredMesh& mesh = file.mesh;
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment kinloop\n";
  for (const std::string& comment : format_frame_comments(file.frame)) bytes += "comment " + comment + "\n";
  fmt::format_to(
      std::back_inserter(bytes),
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
      "property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      file.size(), mesh.triangles.size());
  for (size_t i = 0; i < file.size(); ++i) {
    put_values(bytes, file.point(i).data(), 3);
    put_values(bytes, file.normal(i).data(), 3);
    put_values(bytes, mesh.colors[i].data(), 3);
  }
  constexpr uint8_t kCorners = 3;
  for (const Triangle& triangle : mesh.triangles) {
    put_values(bytes, &kCorners, 1);
    put_values(bytes, triangle.data(), 3);
  }
  return bytes;
}

std::string obj_text(const FileMesh& file) {
  constexpr double kFull = 255;
  std::string text = "# kinloop: vertices x y z red green blue\n";
  for (const std::string& comment : format_frame_comments(file.frame)) text += "# " + comment + "\n";
  for (size_t i = 0; i < file.size(); ++i) {
    const auto& [red, green, blue] = file.mesh.colors[i];
    const Eigen::Vector3f p = file.point(i);
    fmt::format_to(std::back_inserter(text), "v {:.5f} {:.5f} {:.5f} {:.3f} {:.3f} {:.3f}\n", p.x(), p.y(),
                   p.z(), red / kFull, green / kFull, blue / kFull);
  }
  for (size_t i = 0; i < file.size(); ++i) {
    const Eigen::Vector3f n = file.normal(i);
    fmt::format_to(std::back_inserter(text), "vn {:.3f} {:.3f} {:.3f}\n", n.x(), n.y(), n.z());
  }
  for (const auto& [a, b, c] : file.mesh.triangles) {
    fmt::format_to(std::back_inserter(text), "f {0}//{0} {1}//{1} {2}//{2}\n", a + 1, b + 1, c + 1);
  }
  return text;
}

// Constants of the glTF 2.0 specification.
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr uint16_t kOpaque = 65535;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;

/// The buffer view from `begin` to the current end.
json buffer_view(const std::string& buffer, size_t begin, int target) {
  return {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", buffer.size() - begin}, {"target", target}};
}

/// Minimum and maximum coordinates, which glTF requires.
std::pair<json, json> bounds(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const auto& point : points) box.extend(point);
  const auto list = [](const Eigen::Vector3f& p) { return json{p.x(), p.y(), p.z()}; };
  return {list(box.min()), list(box.max())};
}

/// glTF colours are linear, not sRGB-encoded (IEC 61966-2-1). Of 8 bits, dark ones would be the same.
uint16_t linear(uint8_t pixel) {
  constexpr double kFull = 255;
  const double s = pixel / kFull;
  const double light = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<uint16_t>(std::lround(kOpaque * light));
}

/// Quaternion (x, y, z, w) from the file's frame to glTF's y up: a quarter turn about x from z up, or half a
/// turn from the first camera's y down.
std::array<double, 4> turn_to_y_up(const FileFrame& frame) {
  if (frame.z_up) return {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  return {1, 0, 0, 0};
}

/// The vertices and triangles as bytes, with the offsets of each part.
struct GlbBuffer {
  std::string bytes;
  json views = json::array();
  json accessors = json::array();
};

GlbBuffer glb_buffer(const FileMesh& file) {
  const ColoredMesh& mesh = file.mesh;
  std::vector<Eigen::Vector3f> points, normals;
  for (size_t i = 0; i < file.size(); ++i) {
    points.push_back(file.point(i));
    normals.push_back(file.normal(i));
  }
  GlbBuffer buffer;
  const auto end_part = [&](size_t begin, int target, json accessor) {
    accessor["bufferView"] = buffer.views.size();
    buffer.accessors.push_back(accessor);
    buffer.views.push_back(buffer_view(buffer.bytes, begin, target));
    return buffer.bytes.size();
  };
  for (const auto& point : points) put_values(buffer.bytes, point.data(), 3);
  const auto [low, high] = bounds(points);
  size_t begin = end_part(
      0, kArrayBuffer,
      {{"componentType", kFloat}, {"type", "VEC3"}, {"count", points.size()}, {"min", low}, {"max", high}});
  for (const auto& [red, green, blue] : mesh.colors) {
    const uint16_t rgba[] = {linear(red), linear(green), linear(blue), kOpaque};
    put_values(buffer.bytes, rgba, 4);
  }
  begin = end_part(
      begin, kArrayBuffer,
      {{"componentType", kUnsignedShort}, {"type", "VEC4"}, {"normalized", true}, {"count", points.size()}});
  for (const Triangle& triangle : mesh.triangles) put_values(buffer.bytes, triangle.data(), 3);
  begin =
      end_part(begin, kElementArrayBuffer,
               {{"componentType", kUnsignedInt}, {"type", "SCALAR"}, {"count", 3 * mesh.triangles.size()}});
  for (const auto& normal : normals) put_values(buffer.bytes, normal.data(), 3);
  end_part(begin, kArrayBuffer, {{"componentType", kFloat}, {"type", "VEC3"}, {"count", normals.size()}});
  return buffer;
}

std::string glb_bytes(const FileMesh& file, const std::filesystem::path& path) {
  const auto [buffer, views, accessors] = glb_buffer(file);
  const json primitive = {
      {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}, {"NORMAL", 3}}}, {"indices", 2}, {"material", 0}};
  const json scene = {
      {"asset", {{"version", "2.0"}, {"generator", "kinloop"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"rotation", turn_to_y_up(file.frame)}, {"extras", to_json(file.frame)}}}},
      {"meshes", {{{"primitives", {primitive}}}}},
      {"materials",
       {{{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}}}},
      {"buffers", {{{"byteLength", buffer.size()}}}},
      {"bufferViews", views},
      {"accessors", accessors}};
  std::string text = json_text(scene);
  text.append((4 - text.size() % 4) % 4, ' ');

  std::string bytes = "glTF";
  const auto put = [&](size_t number) {
    const auto value = static_cast<uint32_t>(number);
    put_values(bytes, &value, 1);
  };
  constexpr size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
  const size_t total = kHeaderBytes + kChunkHeaderBytes + text.size() + kChunkHeaderBytes + buffer.size();
  if (!std::in_range<uint32_t>(total))
    throw InputError(fmt::format("{}: {} bytes, more than .glb can hold; write .ply", path.string(), total));
  put(2);
  put(total);
  put(text.size());
  bytes += "JSON" + text;
  put(buffer.size());
  bytes += std::string("BIN\0", 4) + buffer;
  return bytes;
}

/// STL has triangles without a common list of vertices, each with the normal of its plane, in metres here.
std::string stl_bytes(const FileMesh& file, const std::filesystem::path& path) {
  constexpr size_t kHeaderBytes = 80;
  constexpr uint16_t kNoAttributes = 0;
  const size_t count = file.mesh.triangles.size();
  if (!std::in_range<uint32_t>(count))
    throw InputError(
        fmt::format("{}: {} triangles, more than .stl can hold; write .ply", path.string(), count));
  std::string bytes = "kinloop, metres";  // not "solid", which begins the text format
  bytes.resize(kHeaderBytes, ' ');
  const auto stored_count = static_cast<uint32_t>(count);
  put_values(bytes, &stored_count, 1);
  for (const auto& [a, b, c] : file.mesh.triangles) {
    const Eigen::Vector3f corners[] = {file.point(a), file.point(b), file.point(c)};
    const Eigen::Vector3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    put_values(bytes, normal.data(), 3);
    for (const Eigen::Vector3f& corner : corners) put_values(bytes, corner.data(), 3);
    put_values(bytes, &kNoAttributes, 1);
  }
  return bytes;
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& path) {
  const auto form = path.extension();
  return form == ".ply" || form == ".obj" || form == ".glb" || form == ".stl";
}

void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh, const FileFrame& frame) {
  require(mesh.points.size() == mesh.colors.size(), "write_mesh: expected one colour per vertex");
  require(is_mesh_file(path), "write_mesh: the extension is not supported");
  const FileMesh file{mesh, frame, vertex_normals(mesh)};
  if (path.extension() == ".ply") return write_file(path, ply_bytes(file));
  if (path.extension() == ".obj") return write_file(path, obj_text(file));
  if (path.extension() == ".stl") return write_file(path, stl_bytes(file, path));
  write_file(path, glb_bytes(file, path));
}

}  // namespace kinloop
