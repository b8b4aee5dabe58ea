#pragma once
// Coloured meshes as files: PLY (binary), OBJ (vertex colours as most programs read them) and glTF 2.0 (one
// binary .glb).

#include <filesystem>

#include "kinloop/dense/mesh/colored_mesh.hpp"
#include "kinloop/io/file_frame.hpp"

namespace kinloop {

/// Whether `write_mesh` knows the extension of this name.
bool is_mesh_file(const std::filesystem::path& path);

/// Writes the file atomically, with normals, in the form that its extension names: .ply, .obj or .glb, and in
/// `frame`, which its comments tell; glTF's y is up, so its node turns the vertices that way. Throws
/// InputError when it cannot.
void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh, const FileFrame& frame = {});

}  // namespace kinloop
