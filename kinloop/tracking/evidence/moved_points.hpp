#pragma once
// Finds what has moved into the view: surfaces where earlier views saw through.

#include <span>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// An earlier view of the same scene.
struct SurfaceView {
  const SurfaceGrid* surfaces = nullptr;
  SE3 T_view_frame;
};

/// Returns which grid points of a frame belong to things that have moved, 8UC1 of the grid's size, 255 =
/// moved; empty if there are none. Where no view knows anything, a surface that continues a moved one has
/// moved, too.
cv::Mat moved_points(const SurfaceGrid& surfaces, std::span<const SurfaceView> views);

/// Returns the same for a frame at `T_reference_camera` and the views of a local map; empty without surfaces.
cv::Mat moved_points(const LocalMap& local_map, const Frame& frame, const SE3& T_reference_camera);

}  // namespace kinloop
