#pragma once
// In: points, colours and faces as a file lists them. Out: a mesh of what can be shown of them.

#include <filesystem>
#include <optional>

#include "kinloop/dense/mesh/colored_mesh.hpp"

namespace kinloop {

class MeshBuilder {
 public:
  explicit MeshBuilder(bool colored) : colored_(colored) {}

  /// The next point of the file; `color` is ignored where there are no colours.
  void add(const Eigen::Vector3d& point, const Rgb& color);

  /// A polygon, by numbers of points; they may be points that are added later.
  void add_face(const std::vector<size_t>& corners);

  /// What there is, without points that are not finite. Throws InputError where a face names a point that
  /// there is not, or where no point is left.
  ColoredMesh finish(const std::filesystem::path& path);

 private:
  bool colored_;
  std::optional<Eigen::Vector3d> origin_;  // subtracted from all points
  std::vector<uint32_t> index_of_;         // in the mesh, by number in the file
  std::vector<std::array<size_t, 3>> triangles_;
  ColoredMesh mesh_;
};

/// A colour channel of which `full` is the greatest value, as a byte.
uint8_t to_color_byte(double value, double full);

}  // namespace kinloop
