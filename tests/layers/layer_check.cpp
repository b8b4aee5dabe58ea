#include "tests/layers/layer_check.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include <fmt/format.h>

namespace kinloop::test {
namespace {

namespace fs = std::filesystem;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string> split_words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
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

/// An #include: its opening bracket or quote, and the path.
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

/// The row of the module that contains `path` (relative to the root); null outside of all modules.
const LayerRow* row_of(const std::vector<LayerRow>& rows, const std::string& path) {
  const auto row = std::find_if(rows.begin(), rows.end(),
                                [&](const LayerRow& r) { return path.starts_with(r.folder + "/"); });
  return row == rows.end() ? nullptr : &*row;
}

/// What is wrong with an include in a module; empty if it is allowed. Quotes mean a file of the project.
std::string objection(const std::vector<LayerRow>& rows, const LayerRow& row, const Include& include) {
  const std::string first_folder = include.target.substr(0, include.target.find('/'));
  const bool of_project =
      include.bracket == '"' || contains({"kinloop", "dense", "drivers", "simulator", "tools", "session",
                                          "apps", "tests", "bench", "viewer", "python", "ros"},
                                         first_folder);
  if (!of_project) return {};
  const LayerRow* included = row_of(rows, include.target);
  if (included == nullptr) return "a module includes only modules, by their paths from the root";
  if (included == &row || contains(row.may_include, included->name())) return {};
  return "layers.txt does not let " + row.name() + " include " + included->name();
}

void check_file(const fs::path& file, const std::string& name, const std::vector<LayerRow>& rows,
                const LayerRow& row, std::vector<std::string>& violations) {
  std::ifstream stream(file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto include = parse_include(line);
    if (!include) continue;
    const std::string why = objection(rows, row, *include);
    if (why.empty()) continue;
    violations.push_back(fmt::format("{}:{}: includes {}: {}", name, number, include->target, why));
  }
}

}  // namespace

std::vector<LayerRow> read_layers(const fs::path& layers_file) {
  std::vector<LayerRow> rows;
  std::ifstream stream(layers_file);
  for (std::string line; std::getline(stream, line);) {
    const size_t colon = line.find(':');
    if (line.starts_with('#') || colon == std::string::npos) continue;
    rows.push_back({line.substr(0, colon), split_words(line.substr(colon + 1))});
  }
  return rows;
}

std::vector<std::string> layer_violations(const std::vector<LayerRow>& rows) {
  std::vector<std::string> violations;
  std::vector<std::string> above;
  for (const LayerRow& row : rows) {
    if (contains(above, row.name())) violations.push_back("layers.txt: " + row.name() + " has two rows");
    for (const std::string& module : row.may_include) {
      if (contains(above, module)) continue;
      violations.push_back("layers.txt: " + row.name() + " names " + module + ", which has no row above it");
    }
    above.push_back(row.name());
  }
  return violations;
}

std::vector<std::string> include_violations(const fs::path& root, const std::vector<LayerRow>& rows) {
  std::vector<std::string> violations;
  for (const LayerRow& row : rows) {
    if (!fs::is_directory(root / row.folder)) {
      violations.push_back("layers.txt: there is no folder " + row.folder);
      continue;
    }
    for (const fs::path& file : sources_below(root / row.folder)) {
      check_file(file, fs::relative(file, root).generic_string(), rows, row, violations);
    }
  }
  for (const std::string parent : {"kinloop", "tools"}) {
    if (!fs::exists(root / parent)) continue;
    for (const fs::path& file : sources_below(root / parent)) {
      const std::string path = fs::relative(file, root).generic_string();
      if (row_of(rows, path) == nullptr) violations.push_back(path + ": its folder has no row in layers.txt");
    }
  }
  return violations;
}

}  // namespace kinloop::test
