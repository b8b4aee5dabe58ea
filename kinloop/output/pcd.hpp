#pragma once
// Coloured clouds as binary PCD files, which the Point Cloud Library reads.

#include <filesystem>

#include "kinloop/dense/colored_cloud.hpp"

namespace kinloop {

/// Writes the file atomically. Throws InputError when it cannot.
void write_pcd(const std::filesystem::path& path, const ColoredCloud& cloud);

}  // namespace kinloop
