#pragma once
// In: a source tree with layers.txt. Out: what in it breaks the order of the rooms.

#include <filesystem>
#include <string>
#include <vector>

namespace kinloop::test {

/// A room and the rooms that it may include.
struct LayerRow {
  std::string room;
  std::vector<std::string> may_include;
};

/// The rows of layers.txt, "room: other rooms", from the bottom up.
std::vector<LayerRow> read_layers(const std::filesystem::path& layers_file);

/// One line for each row that is given twice or names a room that is not above it: rows in such an order
/// cannot hold a cycle.
std::vector<std::string> layer_violations(const std::vector<LayerRow>& rows);

/// One line for each room that lacks a row or a folder, and for each file below root/kinloop that includes a
/// project file its room's row does not allow.
std::vector<std::string> include_violations(const std::filesystem::path& root,
                                            const std::vector<LayerRow>& rows);

/// One line for each room whose CMakeLists.txt gives kinloop_room() other ROOMS than its row.
std::vector<std::string> cmake_violations(const std::filesystem::path& root,
                                          const std::vector<LayerRow>& rows);

}  // namespace kinloop::test
