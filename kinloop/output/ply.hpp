#pragma once
// Coloured clouds as binary little-endian PLY files, which MeshLab and CloudCompare open.

#include <filesystem>

#include "kinloop/dense/colored_cloud.hpp"

namespace kinloop {

/// Writes the file atomically. Throws InputError when it cannot.
void write_ply(const std::filesystem::path& path, const ColoredCloud& cloud);

/// Reads a file that `write_ply` wrote: float x, y, z and uchar red, green, blue. Throws InputError naming
/// the file and what is wrong with it.
ColoredCloud read_ply(const std::filesystem::path& path);

}  // namespace kinloop
