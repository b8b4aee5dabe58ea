#include "dense/mesh/colored_mesh.hpp"

#include <Eigen/Geometry>

#include "kinloop/core/disjoint_sets.hpp"

namespace kinloop {

std::vector<Eigen::Vector3f> vertex_normals(const ColoredMesh& mesh) {
  std::vector<Eigen::Vector3f> normals(mesh.points.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f twice_area =
        (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]);
    for (const uint32_t corner : {a, b, c}) normals[corner] += twice_area;
  }
  for (auto& normal : normals) normal.normalize();
  return normals;
}

ColoredMesh remove_small_components(const ColoredMesh& mesh, size_t min_triangles) {
  DisjointSets pieces(mesh.points.size());
  for (const auto& [a, b, c] : mesh.triangles) pieces.join(a, b), pieces.join(b, c);
  std::vector<size_t> size(mesh.points.size(), 0);
  for (const Triangle& triangle : mesh.triangles) ++size[pieces.find(triangle[0])];

  ColoredMesh kept;
  constexpr uint32_t kClosed = ~uint32_t{0};
  std::vector<uint32_t> new_index(mesh.points.size(), kClosed);
  for (uint32_t i = 0; i < mesh.points.size(); ++i) {
    if (size[pieces.find(i)] < min_triangles) continue;
    new_index[i] = static_cast<uint32_t>(kept.points.size());
    kept.points.push_back(mesh.points[i]);
    kept.colors.push_back(mesh.colors[i]);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    if (new_index[a] != kClosed) kept.triangles.push_back({new_index[a], new_index[b], new_index[c]});
  }
  return kept;
}

}  // namespace kinloop
