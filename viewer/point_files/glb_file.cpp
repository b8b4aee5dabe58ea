#include <array>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "viewer/point_files/point_file.hpp"
#include "viewer/point_files/point_formats.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

/// Constants of the glTF 2.0 specification.
const std::map<size_t, NumberType> kComponents = {{5120, NumberType::kInt8},   {5121, NumberType::kUint8},
                                                  {5122, NumberType::kInt16},  {5123, NumberType::kUint16},
                                                  {5125, NumberType::kUint32}, {5126, NumberType::kFloat}};
const std::map<std::string, size_t> kWidths = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                               {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};

constexpr size_t kWord = sizeof(uint32_t);

/// The two chunks of a file, with errors that name it.
class GlbValidator {
 public:
  GlbValidator(std::string_view bytes, const std::filesystem::path& path) : path_(path) { split(bytes); }

  void check() const {
    check_extensions();
    check_buffers();
    for (size_t i = 0; i < list("accessors").size(); ++i) check_accessor(i);
    size_t drawn = 0;
    for (const json& mesh : list("meshes")) {
      for (const json& primitive : mesh.at("primitives")) {
        check_primitive(primitive);
        ++drawn;
      }
    }
    if (drawn == 0) fail("holds no mesh");
  }

  /// Of a file that was checked.
  [[nodiscard]] size_t triangles() const {
    constexpr size_t kTriangles = 4;  // the mode, which others such as strips are seldom written with
    size_t corners = 0;
    for (const json& mesh : list("meshes")) {
      for (const json& primitive : mesh.at("primitives")) {
        if (natural(primitive, "mode", kTriangles) != kTriangles) continue;
        const json& corner =
            primitive.contains("indices") ? primitive["indices"] : primitive["attributes"]["POSITION"];
        corners += natural(list("accessors").at(natural(corner)).at("count"));
      }
    }
    return corners / 3;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", path_.string(), ascii_excerpt(what)));
  }

 private:
  void split(std::string_view bytes) {
    constexpr size_t kHeader = 3 * kWord, kChunkHeader = 2 * kWord;
    if (!bytes.starts_with("glTF") || bytes.size() < kHeader) fail("not a GLB file: missing 'glTF' magic");
    const auto word = [&](size_t at) {
      return static_cast<size_t>(number_at(&bytes[at], NumberType::kUint32));
    };
    constexpr size_t kVersion = 2;
    if (word(kWord) != kVersion) fail(fmt::format("unsupported glTF version {}; expected 2", word(kWord)));
    if (word(2 * kWord) > bytes.size()) fail("truncated; copy the file again");
    std::array<std::string_view, 2> chunks;
    size_t at = kHeader;
    for (std::string_view& chunk : chunks) {
      if (at + kChunkHeader > bytes.size()) break;
      const size_t size = word(at);
      at += kChunkHeader;
      if (size > bytes.size() - at) fail("truncated; copy the file again");
      chunk = bytes.substr(at, size);
      at += size;
    }
    binary_ = chunks[1];
    gltf_ = json::parse(chunks[0], nullptr, false);
    if (!gltf_.is_object()) fail("its JSON part is damaged");
  }

  /// A count, an offset or an index; others, such as 1e21, cannot be converted.
  [[nodiscard]] size_t natural(const json& value) const {
    if (!value.is_number_unsigned()) fail("a count, an offset or an index is no natural number");
    return value.get<size_t>();
  }

  [[nodiscard]] size_t natural(const json& object, const char* name, size_t otherwise) const {
    return object.contains(name) ? natural(object.at(name)) : otherwise;
  }

  [[nodiscard]] const json& list(const char* name) const {
    return gltf_.contains(name) ? gltf_.at(name) : none_;
  }

  void check_extensions() const {
    for (const json& extension : list("extensionsRequired")) {
      const auto name = extension.get<std::string>();
      const bool packed = name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression" ||
                          name == "KHR_texture_basisu";
      if (packed) fail(fmt::format("needs {}; save it without compression", name));
    }
  }

  void check_buffers() const {
    const json &buffers = list("buffers"), &views = list("bufferViews"), &images = list("images");
    for (const json* part : {&buffers, &images}) {
      for (const json& item : *part) {
        const auto uri = item.value("uri", std::string("data:"));
        if (!uri.starts_with("data:")) fail(fmt::format("needs the file '{}'; save it as one file", uri));
      }
    }
    for (size_t i = 0; i < buffers.size(); ++i) {
      const bool inside = i == 0 && !buffers[i].contains("uri");
      if (inside && natural(buffers[i].at("byteLength")) > binary_.size()) fail("its buffer is truncated");
    }
    for (const json& view : views) {
      const size_t size = natural(buffers.at(natural(view.at("buffer"))).at("byteLength"));
      const size_t begin = natural(view, "byteOffset", 0), length = natural(view.at("byteLength"));
      if (begin > size || length > size - begin) fail("a part of its buffer is out of range");
    }
  }

  /// Stride and size of an element, in bytes.
  std::pair<size_t, size_t> step_and_size(const json& accessor, const json& view) const {
    const size_t size = size_of(kComponents.at(natural(accessor.at("componentType")))) *
                        kWidths.at(accessor.at("type").get<std::string>());
    const size_t step = natural(view, "byteStride", size);
    if (step < size) fail("a byteStride is too small");
    return {step, size};
  }

  void check_accessor(size_t number) const {
    const json& accessor = list("accessors").at(number);
    if (!accessor.contains("bufferView")) return;
    const json& view = list("bufferViews").at(natural(accessor.at("bufferView")));
    const auto [step, size] = step_and_size(accessor, view);
    const size_t count = natural(accessor.at("count")), begin = natural(accessor, "byteOffset", 0),
                 length = natural(view.at("byteLength"));
    const size_t room = begin < length ? length - begin : 0;
    if (count > 0 && (room < size || (count - 1) > (room - size) / step)) {
      fail(fmt::format("its accessor {} is out of range", number));
    }
  }

  void check_primitive(const json& primitive) const {
    const json& accessors = list("accessors");
    const json& attributes = primitive.at("attributes");
    if (!attributes.contains("POSITION")) fail("a mesh has no positions");
    const size_t vertices = natural(accessors.at(natural(attributes["POSITION"])).at("count"));
    for (const json& attribute : attributes) {
      if (natural(accessors.at(natural(attribute)).at("count")) != vertices) {
        fail("a mesh has attributes of different lengths");
      }
    }
    if (primitive.contains("indices")) check_indices(accessors.at(natural(primitive["indices"])), vertices);
  }

  void check_indices(const json& accessor, size_t vertices) const {
    if (!accessor.contains("bufferView")) return;
    const json& view = list("bufferViews").at(natural(accessor["bufferView"]));
    const bool inside = view.at("buffer") == 0 && !list("buffers").at(0).contains("uri");
    if (!inside) return;
    const NumberType type = kComponents.at(natural(accessor.at("componentType")));
    const size_t step = step_and_size(accessor, view).first, count = natural(accessor.at("count"));
    const char* at = binary_.data() + natural(view, "byteOffset", 0) + natural(accessor, "byteOffset", 0);
    for (size_t i = 0; i < count; ++i) {
      const double index = number_at(at + i * step, type);
      if (!(index < static_cast<double>(vertices))) {
        fail(fmt::format("a triangle refers to vertex {} of {}", index, vertices));
      }
    }
  }

  const std::filesystem::path& path_;
  std::string_view binary_;
  json gltf_;
  const json none_ = json::array();
};

}  // namespace

std::string read_glb(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  const GlbValidator file(bytes, path);
  try {
    file.check();
  } catch (const json::exception&) {
    file.fail("its JSON part is not glTF");
  } catch (const std::out_of_range&) {  // unknown key of the tables above
    file.fail("its JSON part is not glTF");
  }
  return bytes;
}

size_t count_glb_triangles(std::string_view bytes) {
  return GlbValidator(bytes, "").triangles();
}

}  // namespace kinloop
