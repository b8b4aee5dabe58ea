#pragma once
// In: a mesh. Out: a USD file (Universal Scene Description) as text.

#include <string>

#include "dense/files/file_mesh.hpp"

namespace kinloop {

/// `image` is the name of the file beside it that holds the mesh's texture; empty without one.
std::string usda_text(const FileMesh& file, const std::string& image);

}  // namespace kinloop
