#pragma once
// Readers of PLY and PCD clouds and meshes from any program.

#include <filesystem>
#include <string>
#include <vector>

#include "dense/mesh/colored_mesh.hpp"

namespace kinloop {

/// The content of such a file, without non-finite points and faces that use them.
struct PointFile {
  ColoredMesh mesh;                   ///< no colours if the file has none; polygons are triangulated
  std::vector<std::string> comments;  ///< comments of the header
};

/// Reads any PLY file: ascii, or binary in either byte order, with properties of any type in any order.
/// Throws InputError naming the file and the problem.
PointFile read_any_ply(const std::filesystem::path& path);

/// Reads any PCD file: ascii, binary or binary_compressed, with fields of any type in any order. Throws
/// InputError naming the file and the problem.
PointFile read_any_pcd(const std::filesystem::path& path);

}  // namespace kinloop
