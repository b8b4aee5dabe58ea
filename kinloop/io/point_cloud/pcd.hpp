#pragma once
// Writer of coloured clouds as binary PCD files (Point Cloud Library).

#include <filesystem>

#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "kinloop/io/file_frame.hpp"

namespace kinloop {

/// Writes the file atomically in `frame`, which is noted in a comment, with normals if the cloud has them.
/// Throws InputError on failure.
void write_pcd(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame = {});

}  // namespace kinloop
