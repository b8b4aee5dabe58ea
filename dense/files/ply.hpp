#pragma once
// Coloured clouds as binary little-endian PLY files, readable by MeshLab and CloudCompare.

#include <filesystem>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"

namespace kinloop {

/// Writes the file atomically in `frame`, which is noted in a comment, with normals if the cloud has them.
/// Throws InputError on failure.
void write_ply(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame = {});

/// Reads a file written by `write_ply`: float x, y, z, optional nx, ny, nz, and uchar red, green, blue.
/// Returns the cloud in the world frame, whatever the frame of the file. Throws InputError naming the file
/// and the problem.
ColoredCloud read_ply(const std::filesystem::path& path);

/// Returns the frame of such a file.
FileFrame read_ply_frame(const std::filesystem::path& path);

}  // namespace kinloop
