#pragma once
// The data set format of Nerfstudio and instant-ngp.

#include <filesystem>

#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {

/// Writes sparse_pc.ply (the points) and transforms.json into `folder`, each atomically; images and depth are
/// those that `write_model_images` writes. Cameras have OpenGL's axes: x right, y up, z backwards. Throws
/// InputError on failure.
void write_nerfstudio(const std::filesystem::path& folder, const SparseModel& model);

}  // namespace kinloop
