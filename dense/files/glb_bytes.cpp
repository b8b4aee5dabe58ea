#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dense/files/linear_color.hpp"
#include "dense/files/mesh_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/core/text/json.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

// Constants of the glTF 2.0 specification.
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr uint16_t kOpaque = 65535;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr size_t kWord = 4;
constexpr const char* kUnlit = "KHR_materials_unlit";

/// Minimum and maximum coordinates, which glTF requires.
std::pair<json, json> bounds(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const auto& point : points) box.extend(point);
  const auto list = [](const Eigen::Vector3f& p) { return json{p.x(), p.y(), p.z()}; };
  return {list(box.min()), list(box.max())};
}

/// Of 8 bits, dark linear colours would be the same.
uint16_t linear(uint8_t channel) {
  return static_cast<uint16_t>(std::lround(kOpaque * linear_color(channel)));
}

/// Quaternion (x, y, z, w) from the file's frame to glTF's y up: a quarter turn about x from z up, or half a
/// turn from the first camera's y down.
std::array<double, 4> turn_to_y_up(const FileFrame& frame) {
  if (frame.z_up) return {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  return {1, 0, 0, 0};
}

/// The parts of a file as bytes, and where they are.
struct GlbBuffer {
  std::string bytes;
  json views = json::array();
  json accessors = json::array();

  /// Lists what was added since the last part.
  void end_part(json view) {
    view["buffer"] = 0;
    view["byteOffset"] = begin_;
    view["byteLength"] = bytes.size() - begin_;
    views.push_back(std::move(view));
    bytes.append((kWord - bytes.size() % kWord) % kWord, '\0');
    begin_ = bytes.size();
  }
  void end_array(int target, json accessor) {
    accessor["bufferView"] = views.size();
    accessors.push_back(std::move(accessor));
    end_part({{"target", target}});
  }

 private:
  size_t begin_ = 0;
};

json vectors(const char* type, size_t count) {
  return {{"componentType", kFloat}, {"type", type}, {"count", count}};
}

void add_points(GlbBuffer& buffer, const std::vector<Eigen::Vector3f>& points) {
  for (const auto& point : points) put_values(buffer.bytes, point.data(), 3);
  json accessor = vectors("VEC3", points.size());
  std::tie(accessor["min"], accessor["max"]) = bounds(points);
  buffer.end_array(kArrayBuffer, std::move(accessor));
}

void add_triangles(GlbBuffer& buffer, const std::vector<Triangle>& triangles) {
  for (const Triangle& triangle : triangles) put_values(buffer.bytes, triangle.data(), 3);
  buffer.end_array(kElementArrayBuffer,
                   {{"componentType", kUnsignedInt}, {"type", "SCALAR"}, {"count", 3 * triangles.size()}});
}

/// Vertices with colours: the attributes POSITION, COLOR_0, indices, and NORMAL.
GlbBuffer colored_buffer(const FileMesh& file) {
  std::vector<Eigen::Vector3f> points;
  for (size_t i = 0; i < file.size(); ++i) points.push_back(file.point(i));
  GlbBuffer buffer;
  add_points(buffer, points);
  for (const auto& [red, green, blue] : file.mesh.colors) {
    const uint16_t rgba[] = {linear(red), linear(green), linear(blue), kOpaque};
    put_values(buffer.bytes, rgba, 4);
  }
  buffer.end_array(
      kArrayBuffer,
      {{"componentType", kUnsignedShort}, {"type", "VEC4"}, {"normalized", true}, {"count", file.size()}});
  add_triangles(buffer, file.mesh.triangles);
  for (size_t i = 0; i < file.size(); ++i) put_values(buffer.bytes, file.normal(i).data(), 3);
  buffer.end_array(kArrayBuffer, vectors("VEC3", file.size()));
  return buffer;
}

/// Vertices with places in a texture, a vertex for each place: POSITION, TEXCOORD_0, indices, NORMAL, and the
/// image.
GlbBuffer textured_buffer(const FileMesh& file, std::string_view jpeg) {
  const MeshTexture& texture = *file.texture;
  std::vector<Eigen::Vector3f> points;
  for (const uint32_t vertex : texture.vertex_of_uv) points.push_back(file.point(vertex));
  GlbBuffer buffer;
  add_points(buffer, points);
  for (const Eigen::Vector2f& uv : texture.uvs) put_values(buffer.bytes, uv.data(), 2);
  buffer.end_array(kArrayBuffer, vectors("VEC2", texture.uvs.size()));
  add_triangles(buffer, texture.triangles);
  for (const uint32_t vertex : texture.vertex_of_uv) put_values(buffer.bytes, file.normal(vertex).data(), 3);
  buffer.end_array(kArrayBuffer, vectors("VEC3", points.size()));
  buffer.bytes += jpeg;
  buffer.end_part(json::object());
  return buffer;
}

/// The images already contain the light of the room: programs that know the extension show them as they are.
void add_texture(json& scene, size_t image_view) {
  scene["images"] = {{{"bufferView", image_view}, {"mimeType", "image/jpeg"}}};
  scene["textures"] = {{{"source", 0}}};
  json& material = scene["materials"][0];
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  material["extensions"] = {{kUnlit, json::object()}};
  scene["extensionsUsed"] = {kUnlit};
}

json scene_of(const FileMesh& file, const GlbBuffer& buffer) {
  const char* color = file.texture != nullptr ? "TEXCOORD_0" : "COLOR_0";
  const json primitive = {
      {"attributes", {{"POSITION", 0}, {color, 1}, {"NORMAL", 3}}}, {"indices", 2}, {"material", 0}};
  json scene = {
      {"asset", {{"version", "2.0"}, {"generator", "kinloop"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"rotation", turn_to_y_up(file.frame)}, {"extras", to_json(file.frame)}}}},
      {"meshes", {{{"primitives", {primitive}}}}},
      {"materials",
       {{{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}}}},
      {"buffers", {{{"byteLength", buffer.bytes.size()}}}},
      {"bufferViews", buffer.views},
      {"accessors", buffer.accessors}};
  if (file.texture != nullptr) add_texture(scene, buffer.views.size() - 1);
  return scene;
}

}  // namespace

std::string glb_bytes(const FileMesh& file, std::string_view jpeg, const std::filesystem::path& path) {
  const GlbBuffer buffer = file.texture != nullptr ? textured_buffer(file, jpeg) : colored_buffer(file);
  std::string text = json_text(scene_of(file, buffer));
  text.append((kWord - text.size() % kWord) % kWord, ' ');

  std::string bytes = "glTF";
  const auto put = [&](size_t number) {
    const auto value = static_cast<uint32_t>(number);
    put_values(bytes, &value, 1);
  };
  constexpr size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
  const size_t total =
      kHeaderBytes + kChunkHeaderBytes + text.size() + kChunkHeaderBytes + buffer.bytes.size();
  if (!std::in_range<uint32_t>(total))
    throw InputError(fmt::format("{}: {} bytes, more than .glb can hold; write .ply", path.string(), total));
  put(2);
  put(total);
  put(text.size());
  bytes += "JSON" + text;
  put(buffer.bytes.size());
  bytes += std::string("BIN\0", 4) + buffer.bytes;
  return bytes;
}

}  // namespace kinloop
