#pragma once
// COLMAP's text model.

#include <filesystem>

#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {

/// Writes sparse/0/cameras.txt, images.txt and points3D.txt into `folder`, each atomically; the images are
/// those that `write_model_images` writes. Ids count from 1. COLMAP's pixels are half a pixel larger: (0.5,
/// 0.5) is the centre of the top left one. Throws InputError on failure.
void write_colmap_model(const std::filesystem::path& folder, const SparseModel& model);

}  // namespace kinloop
