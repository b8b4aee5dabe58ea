#pragma once
// Undistorted cameras of the usual sizes.

#include "kinloop/sensor/sensor.hpp"

namespace kinloop::test {

inline PinholeCamera vga_camera() {
  return {.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5, .lens = {}};
}

inline PinholeCamera qvga_camera() {
  return {.width = 320, .height = 240, .fx = 260, .fy = 260, .cx = 159.5, .cy = 119.5, .lens = {}};
}

/// The sensor of an RGB-D camera whose images are those of `camera`.
inline Sensor sensor_of(const PinholeCamera& camera) {
  RgbdCamera rgbd;
  rgbd.color = camera;
  return make_sensor(rgbd);
}

}  // namespace kinloop::test
