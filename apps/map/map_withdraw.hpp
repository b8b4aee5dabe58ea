#pragma once

#include <CLI/CLI.hpp>

namespace kinloop {

/// Adds `withdraw` to the commands of kinloop map: takes false loops out of a map.
void add_map_withdraw_command(CLI::App& map);

}  // namespace kinloop
