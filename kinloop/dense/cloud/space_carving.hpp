#pragma once
// In: points of surfaces, and views. Out: how many of the views looked at the place of each point, and how
// many saw through it: a passer-by that is gone, flying pixels at the edge of things.

#include <span>

#include "kinloop/dense/cloud/surface_points.hpp"

namespace kinloop {

/// What a view saw through.
struct FreeSpaceView {
  SE3 T_camera_world;
  Vector6d velocity = Vector6d::Zero();
  std::vector<uint16_t> nearest;  ///< see ImageSurfels
};

/// Counts for every point the views that looked at its place, nothing before it and depth known or not, and
/// of these the ones that saw through it. The points of a block must stand together.
void count_free_space_violations(std::span<SurfacePoint> points, std::span<const FreeSpaceView> views,
                                 const DenseCamera& camera, double voxel_m, int threads);

}  // namespace kinloop
