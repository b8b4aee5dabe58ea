#pragma once
// Coloured mesh files: PLY (binary), OBJ (with the common vertex colour extension), glTF 2.0 (binary
// .glb), USD (.usda, .usdz) and STL (binary, without colours); with a texture OBJ, glTF and USD.

#include <filesystem>
#include <string_view>
#include <vector>

#include "dense/files/file_frame.hpp"
#include "dense/mesh/colored_mesh.hpp"
#include "dense/texture/mesh_texture.hpp"

namespace kinloop {

/// The extensions that `write_mesh` supports, for messages.
inline constexpr std::string_view kMeshExtensions = ".ply, .obj, .glb, .usda, .usdz or .stl";

/// Those that can have a texture.
inline constexpr std::string_view kTexturedMeshExtensions = ".glb, .obj, .usda or .usdz";

/// Returns whether `write_mesh` supports the extension of this name, without a texture or with one.
bool is_mesh_file(const std::filesystem::path& path);
bool is_textured_mesh_file(const std::filesystem::path& path);

/// Returns the names of the files that `write_mesh` may write for one of this name: itself, a texture,
/// materials.
std::vector<std::filesystem::path> mesh_files(const std::filesystem::path& path);

/// Writes the file atomically, with normals, in the format given by its extension (.ply, .obj, .glb, .usda,
/// .usdz or .stl) and in `frame`, which is noted in a comment (not in STL); in glTF, where y is up, a node
/// rotates the vertices. Throws InputError on failure.
void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh, const FileFrame& frame = {});

/// Throws InputError for the name of a textured mesh that could not name its texture: .obj and .usda are
/// text, in which a line break ends a name.
void require_texture_name(const std::filesystem::path& path);

/// Writes a mesh with its texture as .glb, .obj, .usda or .usdz. The image, a JPEG file, is inside a .glb or
/// .usdz and beside other files, under the same name with .jpg; an .obj also has a .mtl. Throws InputError on
/// failure.
void write_mesh(const std::filesystem::path& path, const ColoredMesh& mesh, const MeshTexture& texture,
                const FileFrame& frame = {});

}  // namespace kinloop
