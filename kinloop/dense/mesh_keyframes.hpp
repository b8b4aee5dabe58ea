#pragma once
// In: stored images, where each was taken, the camera. Out: one coloured mesh in the world.

#include <span>

#include "kinloop/base/progress.hpp"
#include "kinloop/dense/keyframe_images.hpp"
#include "kinloop/dense/posed_image.hpp"
#include "kinloop/dense/tsdf_volume.hpp"

namespace kinloop {

/// The surfaces that the views saw, what passed through and was gone left out. The result does not depend on
/// `threads`. Throws UsageError where this build cannot make meshes.
ColoredMesh mesh_keyframes(const KeyframeImages& images, std::span<const PosedImage> views,
                           const DenseCamera& camera, const MeshOptions& options, int threads,
                           const Progress& progress = {});

}  // namespace kinloop
