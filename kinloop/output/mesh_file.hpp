#pragma once
// Coloured meshes as files: PLY (binary), OBJ (vertex colours as most programs read them) and glTF 2.0 (one
// binary .glb).

#include <filesystem>

#include "kinloop/dense/colored_mesh.hpp"

namespace kinloop {

/// Whether `write_mesh` knows the extension of this name.
bool is_mesh_file(const std::filesystem::path& path);

/// Writes the file atomically, in the form that its extension names: .ply, .obj or .glb. Throws InputError
/// when it cannot.
void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh);

}  // namespace kinloop
