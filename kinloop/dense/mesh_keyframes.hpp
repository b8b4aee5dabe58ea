#pragma once
// In: stored images, where each was taken, the camera. Out: one coloured mesh in the world.

#include "kinloop/dense/fuse_keyframes.hpp"
#include "kinloop/dense/tsdf_volume.hpp"

namespace kinloop {

/// The surfaces that the views saw, what passed through and was gone left out. The result does not depend on
/// `threads`. Throws UsageError where this build cannot make meshes.
ColoredMesh mesh_keyframes(const KeyframeImages& images, std::span<const PosedImage> views,
                           const PinholeCamera& camera, const MeshOptions& options, int threads,
                           const Progress& progress = {});

}  // namespace kinloop
