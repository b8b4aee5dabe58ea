#include "dense/files/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "dense/files/file_mesh.hpp"
#include "dense/files/mesh_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/escaped.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"

namespace kinloop {
namespace {

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

void add_vertices(std::string& text, const FileMesh& file) {
  constexpr double kFull = 255;
  for (size_t i = 0; i < file.size(); ++i) {
    const Eigen::Vector3f p = file.point(i);
    fmt::format_to(std::back_inserter(text), "v {:.5f} {:.5f} {:.5f}", p.x(), p.y(), p.z());
    if (file.texture == nullptr) {
      const auto& [red, green, blue] = file.mesh.colors[i];
      fmt::format_to(std::back_inserter(text), " {:.3f} {:.3f} {:.3f}", red / kFull, green / kFull,
                     blue / kFull);
    }
    text += '\n';
  }
  for (size_t i = 0; i < file.size(); ++i) {
    const Eigen::Vector3f n = file.normal(i);
    fmt::format_to(std::back_inserter(text), "vn {:.3f} {:.3f} {:.3f}\n", n.x(), n.y(), n.z());
  }
}

std::string obj_text(const FileMesh& file) {
  std::string text = "# kinloop: vertices x y z red green blue\n";
  for (const std::string& comment : format_frame_comments(file.frame)) text += "# " + comment + "\n";
  add_vertices(text, file);
  for (const auto& [a, b, c] : file.mesh.triangles) {
    fmt::format_to(std::back_inserter(text), "f {0}//{0} {1}//{1} {2}//{2}\n", a + 1, b + 1, c + 1);
  }
  return text;
}

constexpr const char* kMaterial = "images";

/// The same with a texture, whose material is in the file `material`.
std::string textured_obj_text(const FileMesh& file, const std::string& material) {
  std::string text = "# kinloop\n";
  for (const std::string& comment : format_frame_comments(file.frame)) text += "# " + comment + "\n";
  fmt::format_to(std::back_inserter(text), "mtllib {}\nusemtl {}\n", material, kMaterial);
  add_vertices(text, file);
  for (const Eigen::Vector2f& uv : file.texture->uvs)
    fmt::format_to(std::back_inserter(text), "vt {:.6f} {:.6f}\n", uv.x(), 1 - uv.y());
  for (size_t i = 0; i < file.mesh.triangles.size(); ++i) {
    text += 'f';
    for (size_t k = 0; k < 3; ++k)
      fmt::format_to(std::back_inserter(text), " {0}/{1}/{0}", file.mesh.triangles[i][k] + 1,
                     file.texture->triangles[i][k] + 1);
    text += '\n';
  }
  return text;
}

/// A diffuse material without highlights.
std::string mtl_text(const std::string& image) {
  return fmt::format("newmtl {}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {}\n", kMaterial, image);
}

/// A USD scene and the image of its texture in one file; without an image that is empty.
std::string usdz_of(const FileMesh& file, std::string_view jpeg) {
  const std::string image = jpeg.empty() ? "" : "texture.jpg";
  std::vector<PackagedFile> files = {{"scene.usda", usda_text(file, image)}};
  if (!jpeg.empty()) files.push_back({image, std::string(jpeg)});
  return usdz_bytes(files);
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

std::filesystem::path beside(std::filesystem::path mesh, const char* extension) {
  return mesh.replace_extension(extension);
}

}  // namespace

std::vector<std::filesystem::path> mesh_files(const std::filesystem::path& path) {
  if (path.extension() == ".obj") return {path, beside(path, ".jpg"), beside(path, ".mtl")};
  if (path.extension() == ".usda") return {path, beside(path, ".jpg")};
  return {path};
}

bool is_mesh_file(const std::filesystem::path& path) {
  const auto form = path.extension();
  return form == ".ply" || form == ".stl" || is_textured_mesh_file(path);
}

bool is_textured_mesh_file(const std::filesystem::path& path) {
  const auto form = path.extension();
  return form == ".obj" || form == ".glb" || form == ".usda" || form == ".usdz";
}

void require_texture_name(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const bool is_text = path.extension() == ".obj" || path.extension() == ".usda";
  const auto is_control = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; };
  if (!is_text || std::none_of(name.begin(), name.end(), is_control)) return;
  throw InputError(
      fmt::format("{}: a name with control characters cannot be that of a texture; give another name",
                  escaped(path.string())));
}

void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh, const FileFrame& frame) {
  require(mesh.points.size() == mesh.colors.size(), "write_mesh: expected one colour per vertex");
  require(is_mesh_file(path), "write_mesh: the extension is not supported");
  const FileMesh file{mesh, frame, vertex_normals(mesh)};
  if (path.extension() == ".ply") return write_file(path, ply_bytes(file));
  if (path.extension() == ".obj") return write_file(path, obj_text(file));
  if (path.extension() == ".stl") return write_file(path, stl_bytes(file, path));
  if (path.extension() == ".usda") return write_file(path, usda_text(file, {}));
  if (path.extension() == ".usdz") return write_file(path, usdz_of(file, {}));
  write_file(path, glb_bytes(file, {}, path));
}

void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh, const MeshTexture& texture,
                const FileFrame& frame) {
  constexpr int kJpegQuality = 90;
  require(mesh.triangles.size() == texture.triangles.size(), "write_mesh: expected the texture of this mesh");
  require(is_textured_mesh_file(path), "write_mesh: the extension supports no texture");
  require_texture_name(path);
  const FileMesh file{mesh, frame, vertex_normals(mesh), &texture};
  const std::vector<uint8_t> encoded = encode_jpeg(texture.image, kJpegQuality);
  const std::string_view jpeg(reinterpret_cast<const char*>(encoded.data()), encoded.size());
  if (path.extension() == ".glb") return write_file(path, glb_bytes(file, jpeg, path));
  if (path.extension() == ".usdz") return write_file(path, usdz_of(file, jpeg));
  const std::string image = beside(path, ".jpg").filename().string();
  write_file(beside(path, ".jpg"), jpeg);
  if (path.extension() == ".usda") return write_file(path, usda_text(file, image));
  write_file(beside(path, ".mtl"), mtl_text(image));
  write_file(path, textured_obj_text(file, beside(path, ".mtl").filename().string()));
}

}  // namespace kinloop
