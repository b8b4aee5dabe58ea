#pragma once
// Readers of PLY, PCD and GLB (glTF 2.0) clouds and meshes from any program.

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

/// Returns the bytes of a GLB file, which the page reads. It is checked here, so that damage is reported on
/// the terminal. Throws InputError naming the file and the problem if it is damaged, holds nothing to draw,
/// or needs features that the page lacks (other files, compressed meshes).
std::string read_glb(const std::filesystem::path& path);

/// Returns how many triangles are drawn of a file that read_glb has returned.
size_t count_glb_triangles(std::string_view bytes);

}  // namespace kinloop
