#pragma once
// The surface grid of a camera of 640 x 480 pixels: 64 x 48 points, 10 px apart.

#include "kinloop/sensor/surface_grid.hpp"

namespace kinloop::test {

inline std::shared_ptr<const SurfaceCamera> vga_surface_camera() {
  RgbdCamera camera;
  camera.color.width = 640;
  camera.color.height = 480;
  camera.color.fx = camera.color.fy = 525;
  camera.color.cx = 319.5;
  camera.color.cy = 239.5;
  return make_surface_camera(make_sensor(camera));
}

}  // namespace kinloop::test
