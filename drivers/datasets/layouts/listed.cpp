// Any list that names colour and depth images: a text or CSV file with both in each line, in any order and
// with any other columns, such as associate.txt; or a JSON file with a list of objects that name them. Times
// are the numbers beside the names, or those in the names. The camera is to be given, or lies in the folder.

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/lists/name_times.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// The fields of a line, or the texts and times of a JSON object.
using Row = std::vector<std::string>;

/// A row that names two images that are there.
struct ListedPair {
  fs::path color, depth;
  std::string color_time, depth_time;  ///< as written; empty: none
};

/// Fields between blanks, commas and semicolons, without quotes.
Row fields_of(const std::string& line) {
  Row fields;
  std::string field;
  for (const char c : line + " ") {
    if (std::string_view(" \t\r\n,;").find(c) == std::string_view::npos) {
      if (c != '"' && c != '\'') field += c;
    } else if (!field.empty()) {
      fields.push_back(std::exchange(field, ""));
    }
  }
  return fields;
}

/// Whether a name, or else the header of a PNG, says that the image is depth.
bool holds_depth(const fs::path& name, const fs::path& file) {
  if (lower_case(name.string()).find("depth") != std::string::npos) return is_depth_name(name);
  if (!is_color_name(name)) return is_depth_name(name);
  constexpr size_t kBits = 24, kColors = 25, kEnd = 26;
  std::string header(kEnd, '\0');
  std::ifstream(file, std::ios::binary).read(header.data(), kEnd);
  constexpr char kSixteen = 16, kGrey = 0;
  return header.starts_with("\x89PNG") && header[kBits] == kSixteen && header[kColors] == kGrey;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789.") == std::string::npos;
}

/// The number before a field, else the first one of the row.
std::string time_of(const Row& row, size_t field) {
  if (field > 0 && is_number(row[field - 1])) return row[field - 1];
  const auto first = std::find_if(row.begin(), row.end(), is_number);
  return first == row.end() ? "" : *first;
}

/// Nothing unless the row names a colour and a depth image.
std::optional<ListedPair> pair_in(const Row& row, const fs::path& folder) {
  ListedPair pair;
  for (size_t i = 0; i < row.size(); ++i) {
    std::string name = row[i];
    std::replace(name.begin(), name.end(), '\\', '/');
    const bool image = is_color_name(name) || is_depth_name(name);
    std::error_code absent;
    if (!image || !fs::is_regular_file(folder / name, absent)) continue;
    const bool depth = holds_depth(name, folder / name);
    fs::path& file = depth ? pair.depth : pair.color;
    if (!file.empty()) continue;  // a second one, such as of another camera
    file = folder / name;
    (depth ? pair.depth_time : pair.color_time) = time_of(row, i);
  }
  if (pair.color.empty() || pair.depth.empty()) return std::nullopt;
  return pair;
}

std::string text_of(const nlohmann::json& number) {
  return number.is_number_integer() ? std::to_string(number.get<int64_t>())
                                    : fmt::format("{:.9f}", number.get<double>());
}

void add_row_of(const nlohmann::json& object, std::vector<Row>& rows) {
  Row row;
  for (const auto& [key, value] : object.items()) {
    const std::string name = lower_case(key);
    const bool is_time = name.find("time") != std::string::npos || name.find("stamp") != std::string::npos;
    if (value.is_string()) row.push_back(value.get<std::string>());
    if (value.is_number() && is_time) row.insert(row.begin(), text_of(value));
  }
  rows.push_back(row);
}

/// A row for each object of the first list of objects.
std::vector<Row> rows_of_json(const fs::path& file) {
  const nlohmann::json json = read_json(file);
  std::vector<Row> rows;
  const auto add_list = [&](const nlohmann::json& list) {
    if (!rows.empty() || !list.is_array()) return;
    for (const auto& object : list) {
      if (object.is_object()) add_row_of(object, rows);
    }
  };
  add_list(json);
  if (json.is_object()) {
    for (const auto& value : json) add_list(value);
  }
  return rows;
}

bool is_json(const fs::path& file) {
  return lower_case(file.extension().string()) == ".json";
}

std::vector<Row> rows_of(const fs::path& file) {
  if (is_json(file)) return rows_of_json(file);
  require_size(file, kMostListBytes);
  std::ifstream stream(file);
  std::vector<Row> rows;
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with('#')) rows.push_back(fields_of(line));
  }
  return rows;
}

/// Whether one of the first lines of a file names both images. Errors are said when it is read.
bool names_images(const fs::path& file) {
  constexpr size_t kLines = 5, kLongest = 4096;
  if (is_json(file)) {
    try {
      const auto rows = rows_of_json(file);
      return std::any_of(rows.begin(), rows.begin() + static_cast<ptrdiff_t>(std::min(rows.size(), kLines)),
                         [&](const Row& row) { return pair_in(row, file.parent_path()).has_value(); });
    } catch (const InputError&) {
      return false;
    }
  }
  std::ifstream stream(file, std::ios::binary);
  std::string beginning(kLongest, '\0');
  stream.read(beginning.data(), kLongest);
  beginning.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  if (beginning.find('\0') != std::string::npos) return false;
  size_t begin = 0;
  for (size_t i = 0; i < kLines && begin < beginning.size(); ++i) {
    const size_t end = std::min(beginning.find('\n', begin), beginning.size());
    if (pair_in(fields_of(beginning.substr(begin, end - begin)), file.parent_path())) return true;
    begin = end + 1;
  }
  return false;
}

std::string listed_evidence(const fs::path& folder, const FolderContents& contents) {
  constexpr std::array kEndings = {".txt", ".csv", ".tsv", ".lst", ".list", ".json"};
  constexpr size_t kMostLists = 16;
  size_t looked_at = 0;
  for (const std::string& name : contents.files()) {
    const std::string ending = lower_case(fs::path(name).extension().string());
    if (name.starts_with('.') || std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end())
      continue;
    if (++looked_at > kMostLists) break;
    if (names_images(folder / name)) return name;
  }
  return {};
}

/// The times of all pairs as written; nothing unless all are times.
std::optional<FoundTimes> written_times(const std::vector<ListedPair>& pairs,
                                        std::string ListedPair::*written) {
  std::vector<DecimalNumber> numbers;
  for (const ListedPair& pair : pairs) {
    auto number = parse_decimal(pair.*written);
    if (!number) return std::nullopt;
    numbers.push_back(*std::move(number));
  }
  return times_of(numbers);
}

/// Sets the times that stand beside the names, else those in the names, else those of the frame rate.
void set_times(const std::vector<ListedPair>& pairs, double fps, RecordedSequence& sequence) {
  std::vector<fs::path> color_files;
  for (const ListedPair& pair : pairs) color_files.push_back(pair.color);
  auto color = written_times(pairs, &ListedPair::color_time);
  const auto depth = color ? written_times(pairs, &ListedPair::depth_time) : std::nullopt;
  if (!color) color = times_in_names(color_files);
  sequence.stamps_measured = color.has_value();
  if (!color) return stamp_by_rate(sequence.frames, fps);
  sequence.pairing.times = fmt::format("times are in {}", color->unit.name);
  for (size_t i = 0; i < pairs.size(); ++i) {
    sequence.frames[i].stamp_ns = color->stamps_ns[i];
    sequence.frames[i].depth_stamp_ns = (depth ? depth : color)->stamps_ns[i];
  }
  keep_increasing(sequence);
}

RecordedSequence read_listed(const fs::path& folder) {
  const std::string name = listed_evidence(folder, FolderContents(folder));
  const fs::path file = folder / name;
  RecordedSequence sequence;
  sequence.layout = fmt::format("images listed in {}", name);
  std::vector<ListedPair> pairs;
  std::set<fs::path> seen;
  for (const Row& row : rows_of(file)) {
    auto pair = pair_in(row, folder);
    if (!pair || !seen.insert(pair->color).second) continue;
    sequence.frames.push_back({0, 0, {pair->color}, {pair->depth}, {}, 0});
    pairs.push_back(*std::move(pair));
  }
  if (pairs.empty())
    throw InputError(
        fmt::format("{}: no line names a colour and a depth image that are there", file.string()));
  set_times(pairs, stated_fps(folder), sequence);
  find_masks(folder, sequence);
  return sequence;
}

}  // namespace

SequenceLayout listed_layout() {
  return {"images in a list", "a .txt, .csv or .json that names a colour and a depth image in each line",
          listed_evidence, read_listed};
}

}  // namespace kinloop
