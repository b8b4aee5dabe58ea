#pragma once
// A mesh in the frame of its file, as the writers of all formats take it.

#include <vector>

#include "dense/files/file_frame.hpp"
#include "dense/mesh/colored_mesh.hpp"
#include "dense/texture/mesh_texture.hpp"

namespace kinloop {

struct FileMesh {
  const ColoredMesh& mesh;
  const FileFrame& frame;
  std::vector<Eigen::Vector3f> normals_world;  ///< of the vertices
  const MeshTexture* texture = nullptr;        ///< optional

  [[nodiscard]] size_t size() const { return mesh.points.size(); }
  [[nodiscard]] Eigen::Vector3f point(size_t i) const { return frame.to_file(mesh.points[i]); }
  [[nodiscard]] Eigen::Vector3f normal(size_t i) const { return frame.to_file(normals_world[i]); }
};

}  // namespace kinloop
