// Reads PCD files (https://pointclouds.org/documentation/tutorials/pcd_file_format.html).

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "viewer/point_files/mesh_builder.hpp"
#include "viewer/point_files/point_file.hpp"
#include "viewer/point_files/point_formats.hpp"

namespace kinloop {
namespace {

/// A field of a point: one number, or `count` of them.
struct Field {
  std::string name;
  NumberType type = NumberType::kFloat;
  size_t count = 1;

  [[nodiscard]] size_t bytes() const { return count * size_of(type); }
};

struct Header {
  std::vector<Field> fields;
  size_t points = 0;
  std::string data;  ///< ascii, binary or binary_compressed
  std::vector<std::string> comments;

  [[nodiscard]] size_t point_bytes() const {
    return std::accumulate(fields.begin(), fields.end(), size_t{0},
                           [](size_t sum, const Field& field) { return sum + field.bytes(); });
  }
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw InputError(fmt::format("{}: {}", path.string(), ascii_excerpt(what)));
}

using Words = std::vector<std::string>;

size_t count_of(const std::string& word, const std::filesystem::path& path) {
  constexpr size_t kMaxCount = 4'000'000'000;  // the product of two still fits
  const auto count = parse_count(word);
  if (!count || *count > kMaxCount) fail(path, fmt::format("'{}' in the header is not a count", word));
  return *count;
}

NumberType number_type(const std::string& type, const std::string& size, const std::filesystem::path& path) {
  static const std::map<std::string, NumberType> kTypes = {
      {"I1", NumberType::kInt8},   {"U1", NumberType::kUint8},  {"I2", NumberType::kInt16},
      {"U2", NumberType::kUint16}, {"I4", NumberType::kInt32},  {"U4", NumberType::kUint32},
      {"I8", NumberType::kInt64},  {"U8", NumberType::kUint64}, {"F4", NumberType::kFloat},
      {"F8", NumberType::kDouble}};
  const auto found = kTypes.find(type + size);
  if (found == kTypes.end()) fail(path, fmt::format("TYPE {} with SIZE {} is not a PCD type", type, size));
  return found->second;
}

/// The lines of the header: comments, and others by keyword. DATA comes last, then the body.
struct Lines {
  std::map<std::string, Words> by_keyword;
  std::vector<std::string> comments;
};

Lines take_lines(std::string_view& content, const std::filesystem::path& path) {
  Lines lines;
  while (!lines.by_keyword.contains("DATA")) {
    const size_t end = content.find('\n');
    constexpr size_t kLongestLine = 1 << 16;
    if (end > kLongestLine) {  // also if there is no line end
      fail(path, "not a PCD file, whose header ends with a line DATA");
    }
    std::string_view text = content.substr(0, end);
    content.remove_prefix(end + 1);
    if (text.starts_with("# ")) lines.comments.emplace_back(text.substr(2));
    const std::string keyword(next_word(text));
    if (keyword.empty() || keyword.starts_with('#')) continue;
    Words& words = lines.by_keyword[keyword];
    for (auto word = next_word(text); !word.empty(); word = next_word(text)) words.emplace_back(word);
  }
  return lines;
}

Header take_header(std::string_view& content, const std::filesystem::path& path) {
  Lines taken = take_lines(content, path);
  auto& lines = taken.by_keyword;
  const Words& names = lines["FIELDS"];
  Words& counts = lines["COUNT"];
  if (counts.empty()) counts.assign(names.size(), "1");
  for (const char* keyword : {"SIZE", "TYPE", "COUNT"}) {
    if (lines[keyword].size() != names.size())
      fail(path, fmt::format("its {} and FIELDS differ in number", keyword));
  }
  Header header;
  header.comments = std::move(taken.comments);
  for (size_t i = 0; i < names.size(); ++i) {
    header.fields.push_back(
        {names[i], number_type(lines["TYPE"][i], lines["SIZE"][i], path), count_of(counts[i], path)});
  }
  const auto word_after = [&](const char* keyword) {
    if (lines[keyword].size() != 1) fail(path, fmt::format("its header has no line {}", keyword));
    return lines[keyword].front();
  };
  header.points = lines.contains("POINTS")
                      ? count_of(word_after("POINTS"), path)
                      : count_of(word_after("WIDTH"), path) * count_of(word_after("HEIGHT"), path);
  header.data = word_after("DATA");
  if (header.data != "ascii" && header.data != "binary" && header.data != "binary_compressed") {
    fail(path, fmt::format("DATA {}: expected ascii, binary or binary_compressed", header.data));
  }
  if (header.point_bytes() == 0) fail(path, "points have no fields");
  return header;
}

/// Layout of one field: its value for point i is at `first + i * step`.
struct Column {
  const char* first = nullptr;
  size_t step = 0;
  NumberType type = NumberType::kFloat;

  [[nodiscard]] double at(size_t i) const { return number_at(first + i * step, type); }
};

/// The columns used; a colour is four bytes: blue, green, red and an unused one.
struct Columns {
  std::array<Column, 3> place;
  std::optional<Column> color;
};

/// A compressed body is ordered by field, others by point.
Columns columns_of(const Header& header, const char* bytes, const std::filesystem::path& path) {
  const bool by_field = header.data == "binary_compressed";
  const size_t point_bytes = header.point_bytes();
  size_t offset = 0;
  std::map<std::string, Column> found;
  for (const Field& field : header.fields) {
    if (field.count > 0) {
      found[field.name] = {bytes + offset * (by_field ? header.points : 1),
                           by_field ? field.bytes() : point_bytes, field.type};
    }
    offset += field.bytes();
  }
  Columns columns;
  constexpr std::array kPlace = {"x", "y", "z"};
  for (size_t i = 0; i < kPlace.size(); ++i) {
    if (!found.contains(kPlace[i])) fail(path, "points lack x, y or z");
    columns.place[i] = found[kPlace[i]];
  }
  for (const char* name : {"rgb", "rgba"}) {
    if (found.contains(name) && size_of(found[name].type) == sizeof(uint32_t)) columns.color = found[name];
  }
  return columns;
}

/// Converts an ascii body to a binary one.
std::string binary_from_text(std::string_view text, const Header& header, const std::filesystem::path& path) {
  std::string bytes;
  const auto put = [&bytes](auto value, size_t size) {
    bytes.append(reinterpret_cast<const char*>(&value), size);  // little-endian
  };
  for (size_t i = 0; i < header.points; ++i) {
    for (const Field& field : header.fields) {
      for (size_t k = 0; k < field.count; ++k) {
        const std::string_view word = next_word(text);
        if (word.empty()) fail(path, fmt::format("truncated: {} of {} points present", i, header.points));
        const auto value = parse_number(word);
        if (!value) fail(path, fmt::format("point {}: '{}' is not a number", i, word.substr(0, 20)));
        if (field.type == NumberType::kDouble) {
          put(*value, sizeof(double));
        } else if (field.type == NumberType::kFloat) {
          put(static_cast<float>(*value), sizeof(float));
        } else {
          constexpr double kMaxInteger = 4294967295;  // of all types; 0 stands for what is none
          put(static_cast<int64_t>(std::abs(*value) <= kMaxInteger ? *value : 0), size_of(field.type));
        }
      }
    }
  }
  return bytes;
}

std::string decompressed(std::string_view content, const std::filesystem::path& path) {
  constexpr size_t kSizes = 2 * sizeof(uint32_t);
  if (content.size() < kSizes) fail(path, "truncated");
  const auto compressed = static_cast<size_t>(number_at(content.data(), NumberType::kUint32));
  const auto size = static_cast<size_t>(number_at(content.data() + sizeof(uint32_t), NumberType::kUint32));
  if (compressed > content.size() - kSizes) fail(path, "truncated: copy the file again");
  const auto bytes = decompress_lzf(content.substr(kSizes, compressed), size);
  if (!bytes) fail(path, "its compressed part is damaged");
  return *bytes;
}

}  // namespace

PointFile read_any_pcd(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  std::string_view content = bytes;
  const Header header = take_header(content, path);
  std::string unpacked;
  if (header.data == "ascii") {
    content = unpacked = binary_from_text(content, header, path);
  } else if (header.data == "binary_compressed") {
    content = unpacked = decompressed(content, path);
  }
  const size_t there = content.size() / header.point_bytes();
  if (there < header.points)
    fail(path, fmt::format("truncated: {} of {} points present", there, header.points));

  const Columns columns = columns_of(header, content.data(), path);
  MeshBuilder builder(columns.color.has_value());
  for (size_t i = 0; i < header.points; ++i) {
    Rgb color{};
    if (columns.color) {
      const char* at = columns.color->first + i * columns.color->step;
      for (size_t k = 0; k < 3; ++k) color[k] = static_cast<uint8_t>(at[2 - k]);
    }
    builder.add({columns.place[0].at(i), columns.place[1].at(i), columns.place[2].at(i)}, color);
  }
  return {builder.finish(path), header.comments};
}

}  // namespace kinloop
