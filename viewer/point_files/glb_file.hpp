#pragma once
// GLB files (glTF 2.0). The page reads them; they are checked here, so that damage is reported on the
// terminal.

#include <filesystem>
#include <string>

namespace kinloop {

/// Returns the bytes of the file. Throws InputError naming the file and the problem if it is damaged, holds
/// nothing to draw, or needs features that the page lacks (other files, compressed meshes).
std::string read_glb(const std::filesystem::path& path);

}  // namespace kinloop
