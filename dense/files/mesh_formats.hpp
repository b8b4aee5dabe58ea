#pragma once
// In: a mesh. Out: the bytes of its file in the formats of glTF and USD.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "dense/files/file_mesh.hpp"

namespace kinloop {

/// Returns a binary glTF 2.0 file. `jpeg` is the image of the mesh's texture; empty without one. Throws
/// InputError naming `path` if the format cannot hold so many bytes.
std::string glb_bytes(const FileMesh& file, std::string_view jpeg, const std::filesystem::path& path);

/// Returns a USD file (Universal Scene Description) as text. `image` is the name of the file beside it that
/// holds the mesh's texture; empty without one.
std::string usda_text(const FileMesh& file, const std::string& image);

/// A file of a USD scene.
struct PackagedFile {
  std::string name;
  std::string bytes;
};

/// Returns a USDZ package: a ZIP archive without compression, in which the bytes of every file begin at a
/// multiple of 64, so that a reader can map them into memory (https://openusd.org/release/spec_usdz.html).
/// The first file is the scene; it refers to the others by their names. Together they have less than 4 GiB,
/// else it throws std::logic_error.
std::string usdz_bytes(std::span<const PackagedFile> files);

}  // namespace kinloop
