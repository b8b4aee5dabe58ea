#pragma once
// Coloured clouds as LAS 1.2 files (ASPRS), point format 2, for programs for surveying.

#include <filesystem>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"

namespace kinloop {

/// Writes the file atomically in `frame`, which is noted in a text record. Coordinates are whole steps of
/// 0.1 mm; non-finite points are left out, and normals, which LAS does not have. Throws InputError on failure
/// and if the coordinates are too large for the steps.
void write_las(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame = {});

}  // namespace kinloop
