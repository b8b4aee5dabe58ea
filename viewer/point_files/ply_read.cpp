// Reads PLY files (Turk 1994) of any layout: ascii or binary in either byte order, properties of any type in
// any order, with unknown elements in between.

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "viewer/point_files/mesh_builder.hpp"
#include "viewer/point_files/point_file.hpp"
#include "viewer/point_files/point_formats.hpp"

namespace kinloop {
namespace {

constexpr size_t kNone = std::numeric_limits<size_t>::max();

/// Reads the numbers of the body in sequence.
class Body {
 public:
  Body(std::string_view rest, PlyFormat format, const std::filesystem::path& path)
      : rest_(rest), format_(format), path_(path) {}

  double next(NumberType type) {
    if (format_ == PlyFormat::kAscii) return next_text();
    const size_t size = size_of(type);
    if (rest_.size() < size) fail_short();
    const double value = number_at(rest_.data(), type,
                                   format_ == PlyFormat::kBigEndian ? std::endian::big : std::endian::little);
    rest_.remove_prefix(size);
    return value;
  }

  /// Reads a list length or an index.
  size_t next_count(NumberType type) {
    constexpr double kMaxCount = 4e9;
    const double value = next(type);
    if (!(value >= 0 && value < kMaxCount)) fail(fmt::format("{} is not a valid vertex index", value));
    return static_cast<size_t>(value);
  }

  /// Throws if the rest of the file is too short for the elements, before memory is allocated for them.
  void require_room(const PlyElement& element) {
    size_t least = 0;
    for (const PlyProperty& property : element.properties) {
      // A number in text takes a digit and a space; the last space may be missing.
      least += format_ == PlyFormat::kAscii ? 2 : size_of(property.count_type.value_or(property.type));
    }
    if (least > 0 && element.count > (rest_.size() + 1) / least) fail_short();
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}; the file is damaged", path_.string(), ascii_excerpt(what)));
  }

 private:
  double next_text() {
    const std::string_view word = next_word(rest_);
    if (word.empty()) fail_short();
    const auto value = parse_number(word);
    constexpr size_t kShown = 20;
    if (!value) fail(fmt::format("'{}' is not a number", word.substr(0, kShown)));
    return *value;
  }

  [[noreturn]] void fail_short() const {
    throw InputError(
        fmt::format("{}: truncated: the header declares more data than the file holds; copy the file again",
                    path_.string()));
  }

  std::string_view rest_;
  PlyFormat format_;
  const std::filesystem::path& path_;
};

/// Index of the property, or kNone.
size_t find_property(const PlyElement& element, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (size_t i = 0; i < element.properties.size(); ++i) {
      if (element.properties[i].name == name) return i;
    }
  }
  return kNone;
}

/// Indices of the vertex properties used.
struct VertexFields {
  std::array<size_t, 3> place{}, color{};
  double full_color = 1;

  [[nodiscard]] bool colored() const { return std::find(color.begin(), color.end(), kNone) == color.end(); }
};

VertexFields vertex_fields(const PlyElement& element, const Body& body) {
  VertexFields fields;
  fields.place = {find_property(element, {"x"}), find_property(element, {"y"}),
                  find_property(element, {"z"})};
  fields.color = {find_property(element, {"red", "diffuse_red", "r"}),
                  find_property(element, {"green", "diffuse_green", "g"}),
                  find_property(element, {"blue", "diffuse_blue", "b"})};
  for (const size_t place : fields.place) {
    if (place == kNone) body.fail("vertices lack x, y or z");
  }
  if (!fields.colored()) return fields;
  constexpr double kMaxByte = 255, kMaxWord = 65535;
  const NumberType type = element.properties[fields.color[0]].type;
  fields.full_color = is_floating(type) ? 1 : size_of(type) == 1 ? kMaxByte : kMaxWord;
  return fields;
}

/// Reads a number, or skips a list.
double next_value(Body& body, const PlyProperty& property) {
  if (!property.count_type) return body.next(property.type);
  for (size_t left = body.next_count(*property.count_type); left > 0; --left) body.next(property.type);
  return 0;
}

void read_vertices(Body& body, const PlyElement& element, const VertexFields& fields, MeshBuilder& builder) {
  std::vector<double> values(element.properties.size());
  for (size_t vertex = 0; vertex < element.count; ++vertex) {
    for (size_t i = 0; i < values.size(); ++i) values[i] = next_value(body, element.properties[i]);
    Rgb color{};
    for (size_t i = 0; i < 3 && fields.colored(); ++i) {
      color[i] = to_color_byte(values[fields.color[i]], fields.full_color);
    }
    const auto [x, y, z] = fields.place;
    builder.add({values[x], values[y], values[z]}, color);
  }
}

void read_faces(Body& body, const PlyElement& element, MeshBuilder& builder) {
  const size_t indices = find_property(element, {"vertex_indices", "vertex_index"});
  std::vector<size_t> corners;
  for (size_t face = 0; face < element.count; ++face) {
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i != indices || !property.count_type) {
        next_value(body, property);
        continue;
      }
      corners.clear();
      for (size_t left = body.next_count(*property.count_type); left > 0; --left) {
        corners.push_back(body.next_count(property.type));
      }
      builder.add_face(corners);
    }
  }
}

void skip(Body& body, const PlyElement& element) {
  for (size_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) next_value(body, property);
  }
}

}  // namespace

PointFile read_any_ply(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  std::string_view content = bytes;
  const PlyHeader header = parse_ply_header(content, path);
  Body body(content, header.format, path);
  const auto vertices = std::find_if(header.elements.begin(), header.elements.end(),
                                     [](const PlyElement& element) { return element.name == "vertex"; });
  if (vertices == header.elements.end()) body.fail("it has no vertices");
  const VertexFields fields = vertex_fields(*vertices, body);
  MeshBuilder builder(fields.colored());
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;  // whatever its count
    body.require_room(element);
    if (&element == &*vertices) {
      read_vertices(body, element, fields, builder);
    } else if (element.name == "face") {
      read_faces(body, element, builder);
    } else {
      skip(body, element);
    }
  }
  return {builder.finish(path), header.comments};
}

}  // namespace kinloop
