#pragma once
// Coloured clouds as binary PCD files, which the Point Cloud Library reads.

#include <filesystem>

#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "kinloop/io/file_frame.hpp"

namespace kinloop {

/// Writes the file atomically, in `frame`, which its comments tell; with normals where the cloud has them.
/// Throws InputError when it cannot.
void write_pcd(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame = {});

}  // namespace kinloop
