#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "viewer/point_files/point_formats.hpp"

namespace kinloop {
namespace {

/// A header line, read word by word.
struct Line {
  std::string_view text;
  size_t number = 0;
  const std::filesystem::path& path;

  std::string word() { return std::string(next_word(text)); }

  /// The rest of the line.
  std::string rest() {
    const std::string_view first = next_word(text);
    return first.empty() ? std::string() : std::string(first.data(), text.data() + text.size());
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw_parse_error(path, number, ascii_excerpt(what));
  }
};

NumberType number_type(Line& line) {
  static const std::map<std::string, NumberType> kTypes = {
      {"char", NumberType::kInt8},      {"int8", NumberType::kInt8},     {"uchar", NumberType::kUint8},
      {"uint8", NumberType::kUint8},    {"short", NumberType::kInt16},   {"int16", NumberType::kInt16},
      {"ushort", NumberType::kUint16},  {"uint16", NumberType::kUint16}, {"int", NumberType::kInt32},
      {"int32", NumberType::kInt32},    {"uint", NumberType::kUint32},   {"uint32", NumberType::kUint32},
      {"float", NumberType::kFloat},    {"float32", NumberType::kFloat}, {"double", NumberType::kDouble},
      {"float64", NumberType::kDouble},
  };
  const std::string name = line.word();
  const auto found = kTypes.find(name);
  if (found == kTypes.end()) line.fail(fmt::format("'{}' is not a PLY type (such as float or uchar)", name));
  return found->second;
}

PlyFormat format_of(Line& line) {
  const std::string name = line.word();
  if (name == "ascii") return PlyFormat::kAscii;
  if (name == "binary_little_endian") return PlyFormat::kLittleEndian;
  if (name == "binary_big_endian") return PlyFormat::kBigEndian;
  line.fail(fmt::format("format '{}': expected ascii, binary_little_endian or binary_big_endian", name));
}

PlyElement element_of(Line& line) {
  PlyElement element;
  element.name = line.word();
  const std::string count = line.word();
  const auto number = parse_count(count);
  if (!number) line.fail(fmt::format("'{}' is not a number of elements", count));
  element.count = *number;
  return element;
}

PlyProperty property_of(Line& line) {
  PlyProperty property;
  std::string_view after = line.text;
  if (next_word(after) == "list") {
    line.text = after;
    property.count_type = number_type(line);
  }
  property.type = number_type(line);
  property.name = line.word();
  return property;
}

/// Removes and returns a line without its end: "\n", "\r\n", or "\r" of old programs.
std::string_view take_header_line(std::string_view& content) {
  const size_t end = std::min(content.size(), content.find_first_of("\r\n"));
  const std::string_view text = content.substr(0, end);
  content.remove_prefix(end);
  content.remove_prefix(content.starts_with("\r\n") ? 2 : content.empty() ? 0 : 1);
  return text;
}

}  // namespace

PlyHeader parse_ply_header(std::string_view& content, const std::filesystem::path& path) {
  PlyHeader header;
  bool has_format = false;
  Line line{take_header_line(content), 1, path};
  if (line.word() != "ply") line.fail("not a PLY file, which begins with the line 'ply'");
  while (true) {
    if (content.empty()) line.fail("the header ends without the line 'end_header'; the file is truncated");
    line.text = take_header_line(content);
    ++line.number;
    const std::string keyword = line.word();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.format = format_of(line);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(element_of(line));
    } else if (keyword == "property") {
      if (header.elements.empty()) line.fail("a property before the first element");
      header.elements.back().properties.push_back(property_of(line));
    } else if (keyword == "comment" || keyword == "obj_info") {
      header.comments.push_back(line.rest());
    } else if (!keyword.empty()) {
      line.fail("expected format, element, property, comment or end_header");
    }
  }
  if (!has_format) line.fail("the header has no line 'format'");
  return header;
}

}  // namespace kinloop
