#pragma once
// A coloured triangle mesh of the dense map.

#include <array>
#include <cstdint>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"

namespace kinloop {

/// Corners of a triangle, counterclockwise as seen from the free side.
using Triangle = std::array<uint32_t, 3>;

/// Vertices in the world frame, metres, with colours; triangles as vertex indices.
struct ColoredMesh {
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb> colors;
  std::vector<Triangle> triangles;
};

/// Returns a unit normal per vertex, towards the free side: the area-weighted mean of its triangles' normals.
std::vector<Eigen::Vector3f> vertex_normals(const ColoredMesh& mesh);

/// Removes connected components of fewer than `min_triangles` triangles.
ColoredMesh remove_small_components(const ColoredMesh& mesh, size_t min_triangles);

}  // namespace kinloop
