#pragma once
// Calibrations with a lens and a pose for each of colour and depth, as ScanNet and BundleFusion have them.

#include <filesystem>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// The poses are those of the cameras in the frame whose pose the dataset gives.
struct TwoLenses {
  PinholeCamera color, depth;
  SE3 T_body_color, T_body_depth;
};

/// Returns a camera with registered depth if both lenses are the same. Throws InputError naming `file` if
/// `depth_scale` is not a scale.
RgbdCamera camera_of(const TwoLenses& lenses, double depth_scale, const std::filesystem::path& file);

/// Turns poses of the body into poses of the colour camera.
void move_to_color(const TwoLenses& lenses, Trajectory& trajectory);

}  // namespace kinloop
