#pragma once
// In: a mesh. Out: the bytes of a binary glTF 2.0 file.

#include <filesystem>
#include <string>
#include <string_view>

#include "dense/files/file_mesh.hpp"

namespace kinloop {

/// `jpeg` is the image of the mesh's texture; empty without one. Throws InputError naming `path` if the
/// format cannot hold so many bytes.
std::string glb_bytes(const FileMesh& file, std::string_view jpeg, const std::filesystem::path& path);

}  // namespace kinloop
