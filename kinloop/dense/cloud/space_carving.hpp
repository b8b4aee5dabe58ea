#pragma once
// In: surface points and views. Out: for each point, how many views could see its place and how many of them
// measured free space there. Such points are people who passed by or flying pixels at depth edges.

#include <span>

#include "kinloop/dense/cloud/surface_points.hpp"

namespace kinloop {

/// The free space that a view observed.
struct FreeSpaceView {
  SE3 T_camera_world;
  Velocity velocity = {};
  std::vector<uint16_t> nearest;  ///< see ImageSurfels
};

/// Counts for every point the views with its place in sight (unoccluded, whether depth is known or not) and,
/// among them, free-space violations. The points of a block must be adjacent.
void count_free_space_violations(std::span<SurfacePoint> points, std::span<const FreeSpaceView> views,
                                 const DenseCamera& camera, double voxel_m, int threads);

}  // namespace kinloop
