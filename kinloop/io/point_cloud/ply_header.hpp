#pragma once
// In: the beginning of a PLY file (Turk 1994). Out: what its body holds.

#include <filesystem>
#include <string>
#include <vector>

#include "kinloop/io/point_cloud/number_types.hpp"

namespace kinloop {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

/// One number of an element, or a list of them.
struct PlyProperty {
  std::string name;
  NumberType type = NumberType::kFloat;
  std::optional<NumberType> count_type;  ///< of a list: its length comes first
};

/// "vertex", "face" or another: how many there are, and what each holds.
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

/// Takes the header off the front of `content`. Throws InputError naming the file, the line and what is wrong
/// with it.
PlyHeader parse_ply_header(std::string_view& content, const std::filesystem::path& path);

}  // namespace kinloop
