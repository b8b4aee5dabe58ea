#pragma once
// Finds what has moved into the view: surfaces where earlier views saw through.

#include <span>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/sensor.hpp"
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

// What moves by itself, found by new keypoints before they become landmarks: an image of a moment before does
// not show them where a scene at rest would. Surfaces cannot tell what enters the view together with a part
// of the room that was never seen.

/// Returns the points of the surface grid of `tracked` around which most keypoints move, 8UC1; empty if there
/// are none, or if too few landmarks are found to tell how precise the comparison is. `earlier` is a frame of
/// a moment before, and `T_earlier_tracked` the motion of the camera since then. Both have their images and
/// octaves; keypoints of `tracked` that observe landmarks are taken to be at rest.
cv::Mat moving_points(const TrackedFrame& tracked, const TrackedFrame& earlier, const SE3& T_earlier_tracked,
                      const Sensor& sensor);

}  // namespace kinloop
