#pragma once
// In: a sparse model. Out: its files for COLMAP and for Nerfstudio.

#include <filesystem>

#include "dense/image_store.hpp"
#include "kinloop/core/progress.hpp"
#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {

/// Writes COLMAP's text model: sparse/0/cameras.txt, images.txt and points3D.txt into `folder`, each
/// atomically; the images are those that `write_model_images` writes. Ids count from 1. COLMAP's pixels are
/// half a pixel larger: (0.5, 0.5) is the centre of the top left one. Throws InputError on failure.
void write_colmap_model(const std::filesystem::path& folder, const SparseModel& model);

/// Writes the data set of Nerfstudio and instant-ngp: sparse_pc.ply (the points) and transforms.json into
/// `folder`, each atomically; images and depth are those that `write_model_images` writes. Cameras have
/// OpenGL's axes: x right, y up, z backwards. Throws InputError on failure.
void write_nerfstudio(const std::filesystem::path& folder, const SparseModel& model);

struct ModelImageOptions {
  bool depth = false;  ///< also write depth/NAME.png: 16 bits, mm, 0 = unknown
  int threads = 1;
};

/// Writes images/NAME.jpg, each atomically, and sets the colours of the points. Images that are those of a
/// pinhole camera already keep their bytes. Throws InputError on failure.
void write_model_images(const std::filesystem::path& folder, SparseModel& model, const ImageStore& store,
                        const ImageUndistorter& undistorter, const ModelImageOptions& options,
                        const Progress& progress = {});

}  // namespace kinloop
