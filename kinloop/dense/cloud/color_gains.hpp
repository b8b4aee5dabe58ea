#pragma once
// In: the surfels of images and the pose of each. Out: factors that make all images show a surface in the
// same colours: automatic exposure and white balance change them while the camera moves.

#include <span>
#include <vector>

#include "kinloop/dense/cloud/fuse_surfels.hpp"

namespace kinloop {

/// Factors for the red, green and blue of every view, with a geometric mean of 1; 1 where a view shares no
/// surface with others. The result does not depend on `threads`.
std::vector<Eigen::Vector3f> color_gains(const SurfelLoader& load_surfels, std::span<const PosedImage> views,
                                         const DenseCamera& camera, int threads);

}  // namespace kinloop
