#pragma once
// A grid of the floor as ROS map_server reads it: FILE.pgm and beside it FILE.yaml.

#include <filesystem>

#include "kinloop/dense/occupancy.hpp"

namespace kinloop {

/// Writes both files atomically, the picture first; `path` names the picture. Throws InputError when it
/// cannot.
void write_grid(const std::filesystem::path& path, const OccupancyGrid& grid);

}  // namespace kinloop
