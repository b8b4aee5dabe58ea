#pragma once
// Coloured clouds as binary little-endian PLY files, which MeshLab and CloudCompare open.

#include <filesystem>

#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "kinloop/io/file_frame.hpp"

namespace kinloop {

/// Writes the file atomically, in `frame`, which its comments tell; with normals where the cloud has them.
/// Throws InputError when it cannot.
void write_ply(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame = {});

/// Reads a file that `write_ply` wrote: float x, y, z, with or without nx, ny, nz, and uchar red, green,
/// blue. The cloud is in the world again, whatever the frame of the file. Throws InputError naming the file
/// and what is wrong with it.
ColoredCloud read_ply(const std::filesystem::path& path);

/// The frame that such a file is written in.
FileFrame read_ply_frame(const std::filesystem::path& path);

}  // namespace kinloop
