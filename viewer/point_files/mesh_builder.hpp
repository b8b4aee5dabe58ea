#pragma once
// In: points, colours and faces as listed in a file. Out: a mesh of the valid ones.

#include <filesystem>
#include <optional>

#include "dense/mesh/colored_mesh.hpp"

namespace kinloop {

class MeshBuilder {
 public:
  explicit MeshBuilder(bool colored) : colored_(colored) {}

  /// Adds the next point of the file; `color` is ignored if the file has no colours.
  void add(const Eigen::Vector3d& point, const Rgb& color);

  /// Adds a polygon of point indices, which may refer to points added later.
  void add_face(const std::vector<size_t>& corners);

  /// Returns the mesh without non-finite points. Throws InputError if a face refers to a nonexistent point or
  /// if no point is left.
  ColoredMesh finish(const std::filesystem::path& path);

 private:
  bool colored_;
  std::optional<Eigen::Vector3d> origin_;  // subtracted from all points
  std::vector<uint32_t> index_of_;         // mesh index by number in the file
  std::vector<std::array<size_t, 3>> triangles_;
  ColoredMesh mesh_;
};

/// Converts a colour channel with maximum `full` to a byte.
uint8_t to_color_byte(double value, double full);

}  // namespace kinloop
