#pragma once
// In: a source tree with layers.txt. Out: the includes that break it.

#include <filesystem>
#include <string>
#include <vector>

namespace kinloop::test {

/// A module's folder, and the names of the modules that it may include.
struct LayerRow {
  std::string folder;
  std::vector<std::string> may_include;

  /// The last part of the folder.
  [[nodiscard]] std::string name() const { return folder.substr(folder.rfind('/') + 1); }
};

/// The rows of layers.txt, "folder: modules", from the bottom up.
std::vector<LayerRow> read_layers(const std::filesystem::path& layers_file);

/// One line for each row that is given twice or names a module that is not above it: rows in such an order
/// cannot hold a cycle.
std::vector<std::string> layer_violations(const std::vector<LayerRow>& rows);

/// One line for each row without a folder, for each file of kinloop/ and tools/ that lies in no module, and
/// for each file that includes a project file its module's row does not allow.
std::vector<std::string> include_violations(const std::filesystem::path& root,
                                            const std::vector<LayerRow>& rows);

}  // namespace kinloop::test
