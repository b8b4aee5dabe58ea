#include "python/bindings/map_file.hpp"

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "dense/texture/texture_mesh.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "python/bindings/dense.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/options.hpp"
#include "python/bindings/pose_graph.hpp"
#include "python/bindings/trajectory.hpp"
#include "session/store/export_sparse_model.hpp"
#include "session/store/rerun_parts.hpp"

namespace kinloop::python {
namespace {

/// Calls `work(open)` without the GIL, one caller at a time.
template <class Work>
auto use(PyMap& map, const Work& work) {
  return without_gil([&] {
    const std::lock_guard lock(map.mutex);
    return work(map.open);
  });
}

FileFrame map_frame(OpenMap& open) {
  return file_frame("z-up", open.up(0), open.views(0));
}

std::shared_ptr<PyMap> load_map(const std::filesystem::path& path, const py::object& options,
                                const py::kwargs& keywords) {
  const auto assignments = assignments_of(options, keywords);
  return without_gil([&] { return std::make_shared<PyMap>(path, assignments); });
}

py::object map_cloud(PyMap& map) {
  if (map.cloud) return map.cloud;
  PythonProgress progress{py::none()};
  auto cloud = use(map, [&](OpenMap& open) {
    return PyCloud{open.cloud(0, hardware_threads(), progress.function()), map_frame(open)};
  });
  progress.rethrow();
  map.cloud = py::cast(std::move(cloud));
  return map.cloud;
}

PyMesh map_mesh(PyMap& map, const py::kwargs& keywords) {
  const auto assignments = assignments_of(keywords, "mesh.");
  PythonProgress progress{py::none()};
  auto mesh = use(map, [&](OpenMap& open) {
    const MeshOptions options = run_options_with(open.options, assignments).mesh;
    const DenseCamera camera = open.dense_camera();
    const auto views = open.recorder.with_color_gains(open.views(0), camera, hardware_threads());
    return PyMesh{reconstruct_textured_mesh({open.recorder.images(), views, camera}, options,
                                            hardware_threads(), progress.function()),
                  map_frame(open)};
  });
  progress.rethrow();
  return mesh;
}

/// What both exports take beside the folder.
struct ExportOptions {
  size_t images = 0, points = 0;
  std::string recording;
};

void export_model(PyMap& map, const std::filesystem::path& colmap, const std::filesystem::path& nerfstudio,
                  const ExportOptions& options) {
  for (const auto& folder : {colmap, nerfstudio}) {
    if (!folder.empty()) require_writable_folder(folder);
  }
  PythonProgress progress{py::none()};
  use(map, [&](OpenMap& open) {
    const FileCloud file =
        file_cloud({"z-up", 0, hardware_threads(), options.points > 0}, open, progress.function());
    export_sparse_model({map.path, colmap, nerfstudio, 0, hardware_threads(), options.images, options.points,
                         options.recording},
                        file, open, progress.function());
  });
  progress.rethrow();
}

void write_parts(PyMap& map, const std::filesystem::path& folder, size_t images,
                 const std::string& recording) {
  PythonProgress progress{py::none()};
  use(map, [&](OpenMap& open) {
    const FileCloud file = file_cloud({"z-up", 0, hardware_threads()}, open, progress.function());
    write_rerun_parts(folder, {map.path, 0, hardware_threads(), images, recording}, file, open,
                      progress.function());
  });
  progress.rethrow();
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> map_landmarks(PyMap& map) {
  return use(map, [](OpenMap& open) {
    const auto ids = open.map.landmark_ids();
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points(static_cast<long>(ids.size()), 3);
    for (size_t i = 0; i < ids.size(); ++i)
      points.row(static_cast<long>(i)) = open.map.p_world(ids[i]).transpose();
    return points;
  });
}

std::vector<std::string> session_inputs(const PyMap& map) {
  std::vector<std::string> inputs;
  for (const SavedSession& session : map.open.saved.sessions) inputs.push_back(session.input);
  return inputs;
}

}  // namespace

void bind_map_file(py::module_& module) {
  py::class_<PyMap, std::shared_ptr<PyMap>>(module, "Map",
                                            R"(A map file, opened to look at it and to export it.

To continue it or to localise in it, pass its path to Slam(camera, load_map=path, localize=True).)")
      .def_static("load", &load_map, py::arg("path"), py::arg("options") = py::none(),
                  "Opens a map file (.kinmap), or that in the folder of a run. Options override those that "
                  "it was made "
                  "with: Map.load(path, dense={\"voxel_m\": 0.02}). Raises InputError.")
      .def_property_readonly(
          "camera", [](const PyMap& map) { return map.open.saved.camera; }, "The Camera.")
      .def_property_readonly("sessions", &session_inputs,
                             "The names of the recordings that it was made from.")
      .def_property_readonly(
          "trajectory",
          [](PyMap& map) {
            return use(map, [](OpenMap& open) {
              return PyTrajectory{trajectory_of(open.session_log(0), open.map)};
            });
          },
          "The Trajectory of the last recording, without doubtful poses.")
      .def_property_readonly(
          "keyframes",
          [](PyMap& map) {
            return use(map, [](OpenMap& open) {
              return PyTrajectory{keyframe_trajectory(open.map, open.component(0))};
            });
          },
          "The Trajectory of the keyframes.")
      .def_property_readonly("landmarks", &map_landmarks, "The landmarks, float64 (N, 3), metres.")
      .def_property_readonly("cloud", &map_cloud, "The coloured Cloud, made when first asked for.")
      .def("mesh", &map_mesh,
           "Returns the surfaces as a coloured Mesh; keywords are the options mesh.*: mesh(texture_px=4096).")
      .def(
          "pose_graph",
          [](PyMap& map) {
            return use(map, [](OpenMap& open) {
              return PyPoseGraph{{make_pose_graph(open.map, open.options.slam.loop), {}, true, {}}};
            });
          },
          "Returns the PoseGraph of the keyframes.")
      .def(
          "export_colmap",
          [](PyMap& map, const std::filesystem::path& folder, size_t images, size_t points,
             const std::string& recording) {
            export_model(map, folder, {}, {images, points, recording});
          },
          py::arg("folder"), py::kw_only(), py::arg("images") = 0, py::arg("points") = 0,
          py::arg("recording") = "",
          "Writes undistorted images, cameras and points as a COLMAP model, from which Gaussian splatting "
          "starts: at least so many images, of which those that the map lacks are read from its recording, "
          "and so many points of the cloud in addition to the landmarks.")
      .def(
          "export_nerfstudio",
          [](PyMap& map, const std::filesystem::path& folder, size_t images, size_t points,
             const std::string& recording) {
            export_model(map, {}, folder, {images, points, recording});
          },
          py::arg("folder"), py::kw_only(), py::arg("images") = 0, py::arg("points") = 0,
          py::arg("recording") = "",
          "Writes undistorted images with depth, and transforms.json, for Nerfstudio.")
      .def("_write_rerun_parts", &write_parts, py::arg("folder"), py::arg("images"), py::arg("recording"))
      .def("__repr__", [](PyMap& map) {
        return fmt::format("<kinloop.Map: {}, {} keyframes>", map.path.string(),
                           map.open.map.keyframes().size());
      });
}

}  // namespace kinloop::python
