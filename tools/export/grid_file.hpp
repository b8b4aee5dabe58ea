#pragma once
// A floor grid for ROS map_server: FILE.pgm with FILE.yaml beside it.

#include <filesystem>

#include "dense/occupancy.hpp"

namespace kinloop {

/// Writes both files atomically, the picture first; `path` names the picture. Throws InputError on failure.
void write_grid(const std::filesystem::path& path, const OccupancyGrid& grid);

}  // namespace kinloop
