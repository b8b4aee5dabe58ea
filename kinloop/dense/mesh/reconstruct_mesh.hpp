#pragma once
// In: stored images, where each was taken, the camera. Out: one coloured mesh in the world.

#include <span>

#include "kinloop/base/progress.hpp"
#include "kinloop/dense/image_store.hpp"
#include "kinloop/dense/mesh/tsdf_volume.hpp"
#include "kinloop/dense/posed_image.hpp"

namespace kinloop {

/// The surfaces that the views saw, what passed through and was gone left out. The result does not depend on
/// `threads`. Throws UsageError where this build cannot make meshes.
ColoredMesh reconstruct_mesh(const ImageStore& images, std::span<const PosedImage> views,
                             const DenseCamera& camera, const MeshOptions& options, int threads,
                             const Progress& progress = {});

}  // namespace kinloop
