#pragma once
// In: the surfels of images, the pose of each, the camera. Out: one coloured cloud in the world.

#include <functional>
#include <span>

#include "kinloop/base/progress.hpp"
#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "kinloop/dense/cloud/image_surfels.hpp"
#include "kinloop/dense/options.hpp"
#include "kinloop/dense/posed_image.hpp"

namespace kinloop {

/// Loads the surfels of a stored image; called from several threads at once, and more than once per image.
using SurfelLoader = std::function<ImageSurfels(size_t image)>;

/// One point per voxel of surface that at least `options.min_observations` of `views` saw and that not more
/// saw through, corrected for the motion of the camera. However little `options.fusion_memory_mib` is, the
/// result is the same: space is then gone through in several slabs. Nor does it depend on `threads`.
ColoredCloud fuse_surfels(const SurfelLoader& load_surfels, std::span<const PosedImage> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads,
                          const Progress& progress = {});

}  // namespace kinloop
