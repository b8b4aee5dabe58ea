#pragma once
// In: the beginning of a PLY file (Turk 1994). Out: the layout of its body.

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/point_files/number_types.hpp"

namespace kinloop {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

/// A property of an element: a number or a list of numbers.
struct PlyProperty {
  std::string name;
  NumberType type = NumberType::kFloat;
  std::optional<NumberType> count_type;  ///< of a list: type of its length, which comes first
};

/// An element ("vertex", "face" or another), its count and properties.
struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;  ///< in the order of the body
  std::vector<std::string> comments;
};

/// Parses and removes the header at the front of `content`. Throws InputError naming the file, the line and
/// the problem.
PlyHeader parse_ply_header(std::string_view& content, const std::filesystem::path& path);

}  // namespace kinloop
