#pragma once
// A mesh of coloured triangles: the surfaces of the dense map.

#include <array>
#include <cstdint>
#include <vector>

#include "kinloop/dense/cloud/colored_cloud.hpp"

namespace kinloop {

/// Corners of a triangle, counterclockwise as seen from the free side.
using Triangle = std::array<uint32_t, 3>;

/// Vertices in the world, metres, each with a colour; triangles by index of vertex.
struct ColoredMesh {
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb> colors;
  std::vector<Triangle> triangles;
};

/// Unit normal of every vertex, towards the free side: the mean of its triangles', weighted by area.
std::vector<Eigen::Vector3f> vertex_normals(const ColoredMesh& mesh);

/// The mesh without its pieces of fewer than `min_triangles` connected triangles.
ColoredMesh remove_small_components(const ColoredMesh& mesh, size_t min_triangles);

}  // namespace kinloop
