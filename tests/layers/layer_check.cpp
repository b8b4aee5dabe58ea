#include "tests/layers/layer_check.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>

namespace kinloop::test {
namespace {

namespace fs = std::filesystem;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<fs::path> entries(const fs::path& folder, bool folders) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() == folders) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<fs::path> sources_below(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (contains({".hpp", ".cpp", ".h", ".inl", ".ipp"}, entry.path().extension().string()))
      found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// An #include: its opening bracket or quote, and what is between the two.
struct Include {
  char bracket;
  std::string target;
};

std::optional<Include> parse_include(const std::string& line) {
  constexpr const char* kBlanks = " \t";
  size_t at = line.find_first_not_of(kBlanks);
  if (at == std::string::npos || line[at] != '#') return std::nullopt;
  at = line.find_first_not_of(kBlanks, at + 1);
  if (at == std::string::npos || line.compare(at, 7, "include") != 0) return std::nullopt;
  const size_t open = line.find_first_of("<\"", at);
  if (open == std::string::npos) return std::nullopt;
  const size_t close = line.find_first_of(">\"", open + 1);
  return Include{line[open], line.substr(open + 1, close - open - 1)};
}

/// What is wrong with a room's including something; empty when nothing is. Quotes mean a file of the project.
std::string objection(const LayerRow& row, const Include& include) {
  const std::string first_folder = include.target.substr(0, include.target.find('/'));
  const bool of_project = include.bracket == '"' ||
                          contains({"kinloop", "apps", "tests", "bench", "viewer", "python"}, first_folder);
  if (!of_project) return {};
  if (first_folder != "kinloop") return "rooms include nothing of the project but \"kinloop/<room>/...\"";
  const size_t room_at = first_folder.size() + 1;
  const std::string room = include.target.substr(room_at, include.target.find('/', room_at) - room_at);
  if (room == row.room || contains(row.may_include, room)) return {};
  return "layers.txt does not let " + row.room + " include " + room;
}

void check_file(const fs::path& file, const std::string& name, const LayerRow& row,
                std::vector<std::string>& violations) {
  std::ifstream stream(file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto include = parse_include(line);
    if (!include) continue;
    const std::string why = objection(row, *include);
    if (why.empty()) continue;
    violations.push_back(fmt::format("{}:{}: includes {}: {}", name, number, include->target, why));
  }
}

/// The rooms that the call of kinloop_room() in a CMakeLists.txt lists; nothing where it is not of this room.
std::optional<std::vector<std::string>> linked_rooms(const std::string& cmake, const std::string& room) {
  const std::string opening = "kinloop_room(";
  const size_t call = cmake.find(opening);
  if (call == std::string::npos) return std::nullopt;
  const size_t begin = call + opening.size();
  const auto words = words_of(cmake.substr(begin, cmake.find(')', begin) - begin));
  if (words.empty() || words[0] != room) return std::nullopt;
  const auto keyword = std::find(words.begin(), words.end(), "ROOMS");
  if (keyword == words.end()) return std::vector<std::string>{};
  return std::vector<std::string>(keyword + 1, std::find(keyword, words.end(), "LIBRARIES"));
}

}  // namespace

std::vector<LayerRow> read_layers(const fs::path& layers_file) {
  std::vector<LayerRow> rows;
  std::ifstream stream(layers_file);
  for (std::string line; std::getline(stream, line);) {
    const size_t colon = line.find(':');
    if (line.starts_with('#') || colon == std::string::npos) continue;
    rows.push_back({line.substr(0, colon), words_of(line.substr(colon + 1))});
  }
  return rows;
}

std::vector<std::string> layer_violations(const std::vector<LayerRow>& rows) {
  std::vector<std::string> violations;
  std::vector<std::string> above;
  for (const LayerRow& row : rows) {
    if (contains(above, row.room)) violations.push_back("layers.txt: " + row.room + " has two rows");
    for (const std::string& room : row.may_include) {
      if (contains(above, room)) continue;
      violations.push_back("layers.txt: " + row.room + " names " + room + ", which has no row above it");
    }
    above.push_back(row.room);
  }
  return violations;
}

std::vector<std::string> include_violations(const fs::path& root, const std::vector<LayerRow>& rows) {
  std::vector<std::string> violations;
  std::set<std::string> folders;
  for (const fs::path& folder : entries(root / "kinloop", true)) {
    const std::string room = folder.filename().string();
    folders.insert(room);
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.room == room; });
    if (row == rows.end()) {
      violations.push_back("kinloop/" + room + ": has no row in layers.txt");
      continue;
    }
    for (const fs::path& file : sources_below(folder)) {
      check_file(file, fs::relative(file, root).generic_string(), *row, violations);
    }
  }
  for (const LayerRow& row : rows) {
    if (!folders.contains(row.room))
      violations.push_back("layers.txt: " + row.room + " has no folder in kinloop/");
  }
  for (const fs::path& file : entries(root / "kinloop", false)) {
    if (file.filename() != "CMakeLists.txt") {
      violations.push_back("kinloop/" + file.filename().string() + ": lies outside of all rooms");
    }
  }
  return violations;
}

std::vector<std::string> cmake_violations(const fs::path& root, const std::vector<LayerRow>& rows) {
  std::vector<std::string> violations;
  for (const LayerRow& row : rows) {
    auto linked = linked_rooms(content_of(root / "kinloop" / row.room / "CMakeLists.txt"), row.room);
    auto allowed = row.may_include;
    if (linked) std::sort(linked->begin(), linked->end());
    std::sort(allowed.begin(), allowed.end());
    if (linked != allowed) {
      violations.push_back("kinloop/" + row.room +
                           "/CMakeLists.txt: ROOMS differ from the row in layers.txt");
    }
  }
  return violations;
}

}  // namespace kinloop::test
