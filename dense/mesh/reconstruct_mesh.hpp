#pragma once
// In: stored images, their poses, the camera. Out: one coloured mesh in the world frame.

#include <span>

#include "dense/image_store.hpp"
#include "dense/mesh/tsdf_volume.hpp"
#include "dense/posed_image.hpp"
#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Returns the surfaces that the views saw, without moving objects. The result does not depend on `threads`.
/// Throws UsageError if the build has no OpenVDB, or no CGAL where `options` need it.
ColoredMesh reconstruct_mesh(const StoredViews& stored, const MeshOptions& options, int threads,
                             const Progress& progress = {});

}  // namespace kinloop
