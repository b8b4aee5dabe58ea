#pragma once

#include <CLI/CLI.hpp>

namespace kinloop {

/// Adds `locate` to the commands of kinloop map: says in which of several maps the frames of a sequence are.
void add_map_locate_command(CLI::App& map);

}  // namespace kinloop
