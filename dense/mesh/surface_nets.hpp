#pragma once
// Surface nets (Gibson 1998): one vertex in every cell of eight voxels that the surface crosses, and two
// triangles across every edge between voxels that it crosses. Here: the vertex of a cell.

#include <array>
#include <optional>

#include <Eigen/Core>

namespace kinloop {

/// Signed distances at the corners of a cell. Corner k is at (k & 1, k >> 1 & 1, k >> 2).
using CellCorners = std::array<float, 8>;

/// Returns the vertex of a cell, in the unit cube: the mean of the crossings of its edges. nullopt if the
/// surface does not cross it.
inline std::optional<Eigen::Vector3d> surface_vertex(const CellCorners& corners) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int crossings = 0;
  for (int k = 0; k < 8; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      const int other = k | 1 << axis;
      if (other == k) continue;
      const float a = corners[static_cast<size_t>(k)], b = corners[static_cast<size_t>(other)];
      if ((a < 0) == (b < 0)) continue;
      Eigen::Vector3d crossing(k & 1, k >> 1 & 1, k >> 2);
      crossing(axis) += static_cast<double>(a) / (static_cast<double>(a) - static_cast<double>(b));
      sum += crossing;
      ++crossings;
    }
  }
  if (crossings == 0) return std::nullopt;
  return sum / crossings;
}

}  // namespace kinloop
