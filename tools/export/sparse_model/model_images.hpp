#pragma once
// Writes the images of a sparse model.

#include <filesystem>

#include "dense/image_store.hpp"
#include "kinloop/core/progress.hpp"
#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {

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
