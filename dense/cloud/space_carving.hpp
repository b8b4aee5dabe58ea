#pragma once
// In: surface points and views. Out: for each point, how many views contradict it. Such points are people who
// passed by or flying pixels at depth edges.

#include <span>

#include "dense/surfels/surface_points.hpp"

namespace kinloop {

/// The free space that a view observed.
struct MeasuredFreeSpace {
  SE3 T_camera_world;
  Velocity velocity = {};
  double depth_stamp_difference_s = 0;  ///< PosedImage::depth_stamp_difference_s
  std::vector<uint16_t> nearest;        ///< see ImageSurfels
};

/// Adds to each point the number of views that contradict it, and tells which were seen through. For a point
/// that `options.min_observations` images observed, these are the views that measured free space at its place
/// (none if `options.carve` is off); for other points, all views with its place in sight: unoccluded, whether
/// depth is known or not. The points of a block must be adjacent.
void count_contradictions(std::span<SurfacePoint> points, std::span<const MeasuredFreeSpace> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads);

}  // namespace kinloop
