#pragma once
// Grids that are coarser than an image.

#include <cstddef>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Returns the row-major index of a grid point.
inline size_t grid_index(int width, int x, int y) {
  return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
}

/// Returns the ideal camera of a grid with one point per `block` x `block` pixels.
inline PinholeCamera grid_camera(const PinholeCamera& camera, int block) {
  PinholeCamera grid;
  const double scale = 1.0 / block;
  grid.width = camera.width / block;
  grid.height = camera.height / block;
  grid.fx = camera.fx * scale;
  grid.fy = camera.fy * scale;
  grid.cx = (camera.cx + 0.5) * scale - 0.5;  // pixel centres have integer coordinates
  grid.cy = (camera.cy + 0.5) * scale - 0.5;
  return grid;
}

}  // namespace kinloop
