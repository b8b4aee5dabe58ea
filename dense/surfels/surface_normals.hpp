#pragma once
// In: the surfels of images and the pose of each. Out: surface normals, for estimating the up direction.

#include <span>
#include <vector>

#include "dense/surfels/fuse_surfels.hpp"

namespace kinloop {

/// Returns one unit normal, towards the cameras, per surface voxel of about 5 cm; edges, where normals
/// disagree, are left out. Uses at most a few dozen views, evenly spread.
std::vector<Eigen::Vector3f> surface_normals(const SurfelLoader& load_surfels,
                                             std::span<const PosedImage> views, const DenseCamera& camera);

}  // namespace kinloop
