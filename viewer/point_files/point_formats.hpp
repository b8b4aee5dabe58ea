#pragma once
// What the readers of point files share: number types, the header of PLY, the compression of PCD.

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kinloop {

// Number types of point files: ten binary types in either byte order, and text.

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

/// Size of a number, bytes.
constexpr size_t size_of(NumberType type) {
  constexpr std::array<size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

constexpr bool is_floating(NumberType type) {
  return type == NumberType::kFloat || type == NumberType::kDouble;
}

/// Reads the number in the `size_of(type)` bytes at `at`.
double number_at(const char* at, NumberType type, std::endian order = std::endian::little);

/// Removes and returns the next word of `text`; empty at its end.
std::string_view next_word(std::string_view& text);

/// Parses all of `word` as a number, including "nan" and "inf".
std::optional<double> parse_number(std::string_view word);

/// Same for an unsigned integer.
std::optional<size_t> parse_count(std::string_view word);

/// Shortens `text`, which may come from a damaged file, and reduces it to plain ASCII for messages on a
/// terminal.
std::string ascii_excerpt(std::string text);

// In: the beginning of a PLY file (Turk 1994). Out: the layout of its body.

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

// LZF compression, as used by PCD files (Lehmann, liblzf).

/// Decompresses to `size` bytes; nullopt if the data is invalid.
std::optional<std::string> decompress_lzf(std::string_view compressed, size_t size);

}  // namespace kinloop
