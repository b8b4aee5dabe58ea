#pragma once
// In: the surfels of images and the pose of each. Out: gains that compensate automatic exposure and white
// balance, so that all images show a surface in the same colours.

#include <span>
#include <vector>

#include "dense/surfels/fuse_surfels.hpp"

namespace kinloop {

/// Returns whether exposure acts as a factor on a colour: brighter ones are clipped; black level, stray light
/// and compression add a few levels to darker ones, which would look like a change of colour.
bool is_well_exposed(const Rgb& color);

/// Returns gains for red, green and blue of every view, with a geometric mean of 1; 1 for a view that shares
/// no surface with others. The result does not depend on `threads`.
std::vector<Eigen::Vector3f> color_gains(const SurfelLoader& load_surfels, std::span<const PosedImage> views,
                                         const DenseCamera& camera, int threads);

}  // namespace kinloop
