#pragma once

#include <CLI/CLI.hpp>

namespace kinloop {

/// Adds `diff` to the commands of kinloop map: compares two maps of one place.
void add_map_diff_command(CLI::App& map);

}  // namespace kinloop
