#pragma once
// The commands of kinloop map.

#include <CLI/CLI.hpp>

namespace kinloop {

/// Adds `diff` to the commands of kinloop map: compares two maps of one place.
void add_map_diff_command(CLI::App& map);

/// Adds `locate` to the commands of kinloop map: says in which of several maps the frames of a sequence are.
void add_map_locate_command(CLI::App& map);

/// Adds `withdraw` to the commands of kinloop map: takes false loops out of a map.
void add_map_withdraw_command(CLI::App& map);

}  // namespace kinloop
