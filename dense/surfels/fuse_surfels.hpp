#pragma once
// In: the surfels and pose of each image, and the camera. Out: one coloured cloud in the world frame.

#include <functional>
#include <span>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"
#include "dense/surfels/image_surfels.hpp"
#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Loads the surfels of a stored image; called from several threads at once, and more than once per image.
using SurfelLoader = std::function<ImageSurfels(size_t image)>;

/// Returns one point per surface voxel that at least `options.min_observations` of `views` saw and that not
/// more views contradict by a free-space violation, without remnants (see find_remnants); motion-compensated.
/// The result does not depend on `options.fusion_memory_mib` (with less memory, space is processed in more
/// slabs) nor on `threads`.
ColoredCloud fuse_surfels(const SurfelLoader& load_surfels, std::span<const PosedImage> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads,
                          const Progress& progress = {});

/// Returns one unit normal, towards the cameras, per surface voxel of about 5 cm; edges, where normals
/// disagree, are left out. Uses at most a few dozen views, evenly spread.
std::vector<Eigen::Vector3f> surface_normals(const SurfelLoader& load_surfels,
                                             std::span<const PosedImage> views, const DenseCamera& camera);

}  // namespace kinloop
