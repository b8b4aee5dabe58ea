#include <algorithm>
#include <cctype>
#include <sstream>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "tools/evaluation/trajectory_files/columns.hpp"

namespace kinloop {
namespace {

std::string trimmed(const std::string& text) {
  const char* const blanks = " \t\r\"'";
  const size_t begin = text.find_first_not_of(blanks);
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

char separator_of(const std::string& text) {
  for (const char separator : {',', ';'}) {
    if (text.find(separator) != std::string::npos) return separator;
  }
  return ' ';
}

/// Fields of a line; empty ones count between commas, but not after the last.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> fields;
  std::istringstream stream(text);
  const char separator = separator_of(text);
  if (separator == ' ') {
    for (std::string word; stream >> word;) fields.push_back(word);
    return fields;
  }
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(trimmed(field));
  if (!fields.empty() && fields.back().empty()) fields.pop_back();
  return fields;
}

bool begins_like_a_number(const std::string& field) {
  return !field.empty() && (std::isdigit(static_cast<unsigned char>(field[0])) != 0 ||
                            std::string("+-.").find(field[0]) != std::string::npos);
}

}  // namespace

NumberTable read_number_table(const std::filesystem::path& path) {
  std::string bytes = read_text(path);
  if (bytes.find('\0') != std::string::npos)
    throw InputError(
        fmt::format("{}: not a text file; expected lines 'timestamp tx ty tz qx qy qz qw'", path.string()));
  std::istringstream content(std::move(bytes));
  NumberTable table;
  std::string text;
  for (size_t number = 1; std::getline(content, text); ++number) {
    const std::string line = trimmed(text);
    if (line.empty()) continue;
    const bool is_comment = line[0] == '#' || line[0] == '%';
    auto fields = split(is_comment ? line.substr(1) : line);
    if (fields.empty()) continue;
    const bool is_header = table.rows.empty() && !begins_like_a_number(fields[0]) && fields[0] != "nan";
    if (is_comment || is_header) {
      if (table.rows.empty()) table.names = std::move(fields);
      continue;
    }
    table.has_commas = table.has_commas || separator_of(line) != ' ';
    table.rows.push_back({number, std::move(fields)});
  }
  if (table.rows.empty())
    throw InputError(
        fmt::format("{}: has no poses; expected lines 'timestamp tx ty tz qx qy qz qw'", path.string()));
  return table;
}

}  // namespace kinloop
