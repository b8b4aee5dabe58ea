#pragma once
// Meshes in GLB files (glTF 2.0), which the page reads; here they are checked, so that a damaged one is told
// of on the terminal.

#include <filesystem>
#include <string>

namespace kinloop {

/// The bytes of the file. Throws InputError naming the file and what is wrong with it: where it is damaged,
/// holds nothing to draw, or needs what the page does not have (other files, compressed meshes).
std::string read_glb(const std::filesystem::path& path);

}  // namespace kinloop
