#pragma once
// The surface grid of a camera of 640 x 480 pixels: 64 x 48 points, 10 px apart.

#include "kinloop/sensor/surfaces/surface_grid.hpp"
#include "tests/support/pinhole_cameras.hpp"

namespace kinloop::test {

inline std::shared_ptr<const SurfaceCamera> vga_surface_camera() {
  return make_surface_camera(sensor_of(vga_camera()));
}

}  // namespace kinloop::test
