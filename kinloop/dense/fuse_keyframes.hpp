#pragma once
// In: stored images, where each was taken, the camera. Out: one coloured cloud in the world.

#include <span>

#include "kinloop/base/progress.hpp"
#include "kinloop/dense/colored_cloud.hpp"
#include "kinloop/dense/keyframe_images.hpp"
#include "kinloop/dense/options.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// A stored image and where it was taken.
struct PosedImage {
  size_t image = 0;  ///< index into the KeyframeImages
  SE3 T_world_camera;
};

/// One point per voxel that at least `options.min_observations` of `views` saw: the mean of its pixels, in
/// the order of the voxels. Depth is that of the raw colour image. The result does not depend on `threads`.
ColoredCloud fuse_keyframes(const KeyframeImages& images, std::span<const PosedImage> views,
                            const PinholeCamera& camera, const DenseOptions& options, int threads,
                            const Progress& progress = {});

}  // namespace kinloop
