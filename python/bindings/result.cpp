#include "python/bindings/result.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/dense.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/options.hpp"
#include "python/bindings/pose_graph.hpp"
#include "session/run_quality.hpp"
#include "session/store/run_files.hpp"

namespace kinloop::python {
namespace {

template <class Read>
auto read_slam(const Result& result, const Read& read) {
  return without_gil([&] { return result.run->with_slam(read); });
}

py::object cloud_of(Result& result) {
  if (!result.cloud.is_none()) return result.cloud;
  PythonProgress progress{py::none()};
  auto cloud = without_gil([&] {
    return PyCloud{result.run->fuse_cloud(progress.function()), result.run->file_frame()};
  });
  progress.rethrow();
  result.cloud = py::cast(std::move(cloud));
  return result.cloud;
}

PyMesh mesh_of(const Result& result, const py::kwargs& options) {
  const auto assignments = assignments_of(options, "mesh.");
  PythonProgress progress{py::none()};
  auto mesh = without_gil([&] {
    const MeshOptions settings = run_options_with(result.run->options(), assignments).mesh;
    return PyMesh{result.run->reconstruct(settings, progress.function()), result.run->file_frame()};
  });
  progress.rethrow();
  return mesh;
}

RgbdCamera calibrated(const Result& result) {
  return read_slam(result, [&](const Slam& slam) {
    return calibrated_camera(result.run->camera(), slam.sensor_estimate());
  });
}

PyTrajectory keyframes_of(const Result& result) {
  return read_slam(result, [](const Slam& slam) {
    return PyTrajectory{keyframe_trajectory(slam.map(), slam.component())};
  });
}

PyPoseGraph pose_graph_of(const Result& result) {
  return read_slam(result, [&](const Slam& slam) {
    return PyPoseGraph{{make_pose_graph(slam.map(), slam.options().loop), {}, true, {}}};
  });
}

std::vector<std::pair<uint32_t, uint32_t>> loops_of(const Result& result) {
  return read_slam(result, [](const Slam& slam) {
    std::vector<std::pair<uint32_t, uint32_t>> loops;
    for (const auto& loop : slam.map().loop_closures()) loops.emplace_back(loop.a.value, loop.b.value);
    return loops;
  });
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> landmarks_of(const Result& result) {
  return read_slam(result, [](const Slam& slam) {
    const auto ids = slam.map().landmark_ids();
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points(static_cast<long>(ids.size()), 3);
    for (size_t i = 0; i < ids.size(); ++i)
      points.row(static_cast<long>(i)) = slam.map().p_world(ids[i]).transpose();
    return points;
  });
}

std::pair<size_t, size_t> frame_counts(const Result& result) {
  return {read_slam(result, [](const Slam& slam) { return slam.session_log().size(); }),
          result.trajectory.poses.size()};
}

TrajectoryCovariances covariances_of(const Result& result) {
  return read_slam(result, [&](const Slam& slam) {
    return kinloop::covariances_of(slam.session_log(), slam.map(), result.doubtful);
  });
}

/// float64 (N, 6, 6), NaN where unknown.
py::array_t<double> covariance_array(const Result& result) {
  const TrajectoryCovariances covariances = covariances_of(result);
  py::array_t<double> array({static_cast<py::ssize_t>(covariances.size()), py::ssize_t{6}, py::ssize_t{6}});
  double* to = array.mutable_data();
  for (const auto& covariance : covariances) {
    const Matrix6d values = covariance.value_or(Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()));
    to = std::copy_n(values.data(), values.size(),
                     to);  // by columns, which are the rows of a symmetric matrix
  }
  return array;
}

std::string note_on_trajectory(const Result& result) {
  return read_slam(result, [&](const Slam& slam) {
    return note_on_doubtful_poses(slam.session_log(), slam.map(), result.doubtful);
  });
}

/// As in run.json.
py::dict quality_of(const Result& result) {
  const RunQuality quality = read_slam(
      result, [](const Slam& slam) { return judge(judged_frames(slam.session_log(), slam.map())); });
  py::dict values;
  values["verdict"] = name_of(quality.verdict);
  values["seconds"] = quality.seconds;
  values["seconds_doubtful"] = quality.seconds_doubtful;
  values["seconds_lost"] = quality.seconds_lost;
  values["reasons"] = quality.reasons;
  return values;
}

/// The files of `kinloop run` but for figures and report.
void save_result(Result& result, const std::filesystem::path& path) {
  const RunFolder folder(path);
  const py::object object = cloud_of(result);
  const auto& cloud = object.cast<const PyCloud&>();
  const auto [frames, tracked] = frame_counts(result);
  const nlohmann::json figures = {{"frames", frames}, {"tracked", tracked}};
  const RgbdCamera camera = calibrated(result);
  const PyTrajectory keyframes = keyframes_of(result);
  const PyPoseGraph graph = pose_graph_of(result);
  const TrajectoryCovariances covariances = covariances_of(result);
  const std::string note = note_on_trajectory(result);
  without_gil([&] {
    write_run_files(
        folder,
        {result.trajectory.poses, keyframes.poses, {}, cloud.cloud, cloud.frame, figures, covariances, note});
    write_camera_file(folder.camera(), camera);
    write_g2o(folder.graph(), graph.file);
    result.run->save_map(folder.map_file());
  });
}

}  // namespace

py::list warnings_of(Run& run) {
  const auto warnings = without_gil([&] { return run.warnings(); });
  py::list all;
  for (const InputWarning& warning : warnings) {
    py::dict values;
    values["kind"] = name_of(warning.fault);
    values["evidence"] = warning.evidence;
    values["remedy"] = warning.remedy;
    all.append(values);
  }
  return all;
}

void bind_result(py::module_& module) {
  py::class_<Result>(
      module, "Result",
      "The result of a run, returned by Slam.finish(). Everything is in the world frame, in metres.")
      .def_property_readonly(
          "trajectory", [](const Result& r) { return r.trajectory; },
          "The final Trajectory of all located frames, without doubtful ones unless finish() keeps them.")
      .def_property_readonly(
          "covariances", &covariance_array,
          "The covariance of each pose of the trajectory, float64 (N, 6, 6): of translation (m) and rotation "
          "(rad) in camera axes; NaN if unknown.")
      .def_property_readonly(
          "quality", &quality_of,
          R"(The verdict on the run, a dict: verdict ("good", "doubtful" or "bad"), seconds,
seconds_doubtful, seconds_lost and reasons, a list of texts.)")
      .def_property_readonly(
          "warnings", [](const Result& result) { return warnings_of(*result.run); },
          R"(Where the input contradicts itself, a list of dicts: kind, evidence and remedy. Empty if nothing
was found.)")
      .def_property_readonly("keyframes", &keyframes_of, "The Trajectory of the keyframes.")
      .def_property_readonly("cloud", &cloud_of,
                             "The coloured Cloud of all surfaces, made when first asked for.")
      .def("mesh", &mesh_of, R"(Returns the surfaces as a coloured Mesh.

Keywords are the options mesh.* of the program: mesh(voxel_m=0.02, texture_px=2048). Raises UsageError if this build has
no OpenVDB.)")
      .def_property_readonly("camera", &calibrated, "The Camera, with what was calibrated during the run.")
      .def_property_readonly("landmarks", &landmarks_of, "The landmarks of the map, float64 (N, 3).")
      .def_property_readonly("loops", &loops_of, "The loops closed, as pairs of keyframes.")
      .def("pose_graph", &pose_graph_of, "Returns the PoseGraph of the keyframes.")
      .def_property_readonly(
          "frames", [](const Result& r) { return frame_counts(r).first; }, "Number of frames processed.")
      .def(
          "save_map",
          [](const Result& r, const std::filesystem::path& path) {
            without_gil([&] { r.run->save_map(path); });
          },
          py::arg("path"),
          "Writes the map file (.kinmap), to be continued or localised in. Raises InputError.")
      .def("save", &save_result, py::arg("folder"),
           "Writes trajectory.txt, covariances.txt, keyframes.txt, map.ply, map.kinmap, graph.g2o and "
           "camera.yaml, under the "
           "names of "
           "kinloop run, into a folder that kinloop view, export and mesh take. Raises InputError.")
      .def("__repr__", [](const Result& r) {
        const auto [frames, tracked] = frame_counts(r);
        return fmt::format("<kinloop.Result: {} of {} frames located>", tracked, frames);
      });
}

}  // namespace kinloop::python
