#pragma once
// In: the surfels of images and the pose of each. Out: the normals of what they saw, by which one can tell
// which way is up.

#include <span>
#include <vector>

#include "kinloop/dense/cloud/fuse_surfels.hpp"

namespace kinloop {

/// One unit normal, towards the cameras, per voxel of surface of some 5 cm; edges, where normals differ, are
/// left out. At most a few dozen of the views are looked at, spread evenly.
std::vector<Eigen::Vector3f> surface_normals(const SurfelLoader& load_surfels,
                                             std::span<const PosedImage> views, const DenseCamera& camera);

}  // namespace kinloop
