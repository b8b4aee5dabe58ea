#pragma once
// Writer of coloured clouds as binary PCD files (Point Cloud Library).

#include <filesystem>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"

namespace kinloop {

/// Writes the file atomically in `frame`, which is noted in a comment, with normals if the cloud has them.
/// Throws InputError on failure.
void write_pcd(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame = {});

}  // namespace kinloop
