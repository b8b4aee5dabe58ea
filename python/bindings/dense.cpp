#include "python/bindings/dense.hpp"

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl/filesystem.h>

#include "dense/files/mesh_file.hpp"
#include "dense/files/pcd.hpp"
#include "dense/files/ply.hpp"
#include "kinloop/core/errors.hpp"
#include "python/bindings/arrays.hpp"
#include "tools/export/las.hpp"

namespace kinloop::python {
namespace {

static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float) && sizeof(Rgb) == 3 && sizeof(Triangle) == 12);
static_assert(sizeof(Eigen::Vector2f) == 2 * sizeof(float));

/// A view of rows of three numbers.
template <class T, class Row>
py::array view_of_rows(const std::vector<Row>& rows, const py::object& owner) {
  return rows_view(reinterpret_cast<const T*>(rows.data()), rows.size(), 3, owner);
}

void save_cloud(const PyCloud& cloud, const std::filesystem::path& path) {
  if (path.extension() == ".ply") return write_ply(path, cloud.cloud, cloud.frame);
  if (path.extension() == ".pcd") return write_pcd(path, cloud.cloud, cloud.frame);
  if (path.extension() == ".las") return write_las(path, cloud.cloud, cloud.frame);
  throw UsageError(fmt::format("{}: the name must end in .ply, .pcd or .las", path.string()));
}

void save_mesh(const PyMesh& mesh, const std::filesystem::path& path) {
  if (!is_mesh_file(path))
    throw UsageError(fmt::format("{}: the name must end in {}", path.string(), kMeshExtensions));
  if (!mesh.made.texture) return write_mesh(path, mesh.made.mesh, mesh.frame);
  if (!is_textured_mesh_file(path))
    throw UsageError(fmt::format("{}: the name of a mesh with a texture must end in {}", path.string(),
                                 kTexturedMeshExtensions));
  write_mesh(path, mesh.made.mesh, *mesh.made.texture, mesh.frame);
}

/// The texture of the mesh, or None.
py::object texture_of(const PyMesh& mesh) {
  if (!mesh.made.texture) return py::none();
  return rgb_view(mesh.made.texture->image);
}

/// The rows of a part of the texture, or None.
template <class T, class Row>
py::object texture_rows(const py::object& self, std::vector<Row> MeshTexture::*part, size_t columns) {
  const auto& texture = self.cast<const PyMesh&>().made.texture;
  if (!texture) return py::none();
  const std::vector<Row>& rows = (*texture).*part;
  return rows_view(reinterpret_cast<const T*>(rows.data()), rows.size(), columns, self);
}

Eigen::Matrix4d T_file_world(const FileFrame& frame) {
  return frame.T_file_world().matrix();
}

constexpr const char* kFileFrameDoc =
    "From the world to the coordinates of files, float64 (4, 4): z up where the surfaces tell it.";

void bind_cloud(py::module_& module) {
  py::class_<PyCloud>(module, "Cloud", R"(A coloured point cloud in the world frame, that of the trajectory.

The arrays are read-only views of its memory; they keep it alive.)")
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            return PyCloud{read_ply(path), read_ply_frame(path)};
          },
          py::arg("path"), "Reads a .ply file written by kinloop. Raises InputError.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of_rows<float>(self.cast<const PyCloud&>().cloud.points, self);
          },
          "Points, float32 (N, 3), metres.")
      .def_property_readonly(
          "colors",
          [](const py::object& self) {
            return view_of_rows<uint8_t>(self.cast<const PyCloud&>().cloud.colors, self);
          },
          "Red, green, blue, uint8 (N, 3).")
      .def_property_readonly(
          "normals",
          [](const py::object& self) {
            return view_of_rows<float>(self.cast<const PyCloud&>().cloud.normals, self);
          },
          "Unit normals towards the cameras, float32 (N, 3); (0, 3) if they are not known.")
      .def_property_readonly(
          "T_file_world", [](const PyCloud& cloud) { return T_file_world(cloud.frame); }, kFileFrameDoc)
      .def("save", &save_cloud, py::arg("path"),
           "Writes a .ply, .pcd or .las file, z up as kinloop run does. Raises InputError, or UsageError for "
           "another name.")
      .def("__len__", [](const PyCloud& cloud) { return cloud.cloud.size(); })
      .def("__repr__", [](const PyCloud& cloud) {
        return fmt::format("<kinloop.Cloud: {} points>", cloud.cloud.size());
      });
}

void bind_mesh(py::module_& module) {
  py::class_<PyMesh>(module, "Mesh", R"(A coloured triangle mesh in the world frame, that of the trajectory.

The arrays are read-only views of its memory; they keep it alive.)")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of_rows<float>(self.cast<const PyMesh&>().made.mesh.points, self);
          },
          "Vertices, float32 (V, 3), metres.")
      .def_property_readonly(
          "colors",
          [](const py::object& self) {
            return view_of_rows<uint8_t>(self.cast<const PyMesh&>().made.mesh.colors, self);
          },
          "Red, green, blue of each vertex, uint8 (V, 3).")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return view_of_rows<uint32_t>(self.cast<const PyMesh&>().made.mesh.triangles, self);
          },
          "Indices of vertices, uint32 (T, 3), counterclockwise from the free side.")
      .def_property_readonly("texture", &texture_of,
                             "Pixels of the texture, uint8 (H, W, 3), red first; None without texture_px.")
      .def_property_readonly(
          "uvs", [](const py::object& self) { return texture_rows<float>(self, &MeshTexture::uvs, 2); },
          "Places in the texture, float32 (C, 2), from 0 to 1, from its upper left corner; or None.")
      .def_property_readonly(
          "uv_triangles",
          [](const py::object& self) { return texture_rows<uint32_t>(self, &MeshTexture::triangles, 3); },
          "Indices into uvs of the corners of each triangle, uint32 (T, 3); or None.")
      .def_property_readonly(
          "T_file_world", [](const PyMesh& mesh) { return T_file_world(mesh.frame); }, kFileFrameDoc)
      .def("save", &save_mesh, py::arg("path"),
           "Writes a .ply, .obj, .glb, .usda, .usdz or .stl file, with a texture .obj, .glb, .usda or .usdz, "
           "z up as "
           "kinloop "
           "mesh does. Raises InputError, or UsageError for another name.")
      .def("__repr__", [](const PyMesh& mesh) {
        return fmt::format("<kinloop.Mesh: {} vertices, {} triangles>", mesh.made.mesh.points.size(),
                           mesh.made.mesh.triangles.size());
      });
}

}  // namespace

void bind_dense(py::module_& module) {
  bind_cloud(module);
  bind_mesh(module);
}

}  // namespace kinloop::python
