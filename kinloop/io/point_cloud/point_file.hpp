#pragma once
// Clouds and meshes in PLY and PCD files, however other programs wrote them.

#include <filesystem>
#include <string>
#include <vector>

#include "kinloop/dense/mesh/colored_mesh.hpp"

namespace kinloop {

/// What such a file holds. Points that are not finite, and faces with one of them, are left out.
struct PointFile {
  ColoredMesh mesh;                   ///< without colours where the file has none; faces as triangles
  std::vector<std::string> comments;  ///< of its header
};

/// Reads any PLY file: ascii, or binary in either byte order, with properties of any type in any order.
/// Throws InputError naming the file and what is wrong with it.
PointFile read_any_ply(const std::filesystem::path& path);

/// Reads any PCD file: ascii, binary or binary_compressed, with fields of any type in any order. Throws
/// InputError naming the file and what is wrong with it.
PointFile read_any_pcd(const std::filesystem::path& path);

}  // namespace kinloop
