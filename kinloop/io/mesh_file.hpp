#pragma once
// Coloured mesh files: PLY (binary), OBJ (with the common vertex colour extension), glTF 2.0 (binary
// .glb) and STL (binary, without colours).

#include <filesystem>
#include <string_view>

#include "kinloop/dense/mesh/colored_mesh.hpp"
#include "kinloop/io/file_frame.hpp"

namespace kinloop {

/// The extensions that `write_mesh` supports, for messages.
inline constexpr std::string_view kMeshExtensions = ".ply, .obj, .glb or .stl";

/// Returns whether `write_mesh` supports the extension of this name.
bool is_mesh_file(const std::filesystem::path& path);

/// Writes the file atomically, with normals, in the format given by its extension (.ply, .obj, .glb or .stl)
/// and in `frame`, which is noted in a comment (not in STL); in glTF, where y is up, a node rotates the
/// vertices. Throws InputError on failure.
void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh, const FileFrame& frame = {});

}  // namespace kinloop
