#pragma once
// In: a source tree with layers.txt. Out: the includes that violate it.

#include <filesystem>
#include <string>
#include <vector>

namespace kinloop::test {

/// A module's folder, and the names of the modules that it may include.
struct LayerRow {
  std::string folder;
  std::vector<std::string> may_include;

  /// The last component of the folder.
  [[nodiscard]] std::string name() const { return folder.substr(folder.rfind('/') + 1); }
};

/// The rows of layers.txt, "folder: modules", from the bottom up.
std::vector<LayerRow> read_layers(const std::filesystem::path& layers_file);

/// One line for each row that is duplicate or names a module that is not above it: with this order there can
/// be no cycle.
std::vector<std::string> layer_violations(const std::vector<LayerRow>& rows);

/// One line for each row without a folder, for each file of kinloop/ and tools/ outside of all modules, and
/// for each file that includes a project file not allowed for its module.
std::vector<std::string> include_violations(const std::filesystem::path& root,
                                            const std::vector<LayerRow>& rows);

}  // namespace kinloop::test
