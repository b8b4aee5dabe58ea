#include "python/bindings/trajectory.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/stamps.hpp"
#include "session/store/named_trajectory.hpp"
#include "tools/export/trajectory_writer.hpp"

namespace kinloop::python {
namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

Trajectory trajectory_from(const Doubles& stamps_s, const Doubles& poses) {
  const py::ssize_t n = stamps_s.ndim() == 1 ? stamps_s.shape(0) : -1;
  if (n < 0 || poses.ndim() != 3 || poses.shape(0) != n || poses.shape(1) != 4 || poses.shape(2) != 4) {
    throw UsageError(
        fmt::format("Trajectory: expected stamps_s of shape (N,) and poses of shape (N, 4, 4), got {} and {}",
                    describe_array(stamps_s), describe_array(poses)));
  }
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < n; ++i) {
    using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(poses.data(i, 0, 0));
    trajectory.push_back({stamp_ns_of(stamps_s.at(i)), to_se3(matrix, fmt::format("poses[{}]", i).c_str())});
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns < b.stamp_ns; });
  return trajectory;
}

/// Calls `fill(pose, row)` for the rows of a new array of shape (N, columns...).
template <class T, class Fill>
py::array_t<T> per_pose(const PyTrajectory& trajectory, std::vector<py::ssize_t> shape, const Fill& fill) {
  size_t row = 1;
  for (const auto size : shape) row *= static_cast<size_t>(size);
  shape.insert(shape.begin(), static_cast<py::ssize_t>(trajectory.poses.size()));
  py::array_t<T> array(shape);
  T* at = array.mutable_data();
  for (const StampedPose& pose : trajectory.poses) {
    fill(pose, at);
    at += row;
  }
  return array;
}

py::array_t<double> matrices(const PyTrajectory& trajectory) {
  return per_pose<double>(trajectory, {4, 4}, [](const StampedPose& pose, double* to) {
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(to);
    matrix = pose.T_world_camera.matrix();
  });
}

py::array_t<double> quaternions(const PyTrajectory& trajectory) {
  return per_pose<double>(trajectory, {4}, [](const StampedPose& pose, double* to) {
    Eigen::Map<Eigen::Vector4d> xyzw(to);
    xyzw = pose.T_world_camera.rotation.coeffs();
  });
}

PyTrajectory slice_of(const PyTrajectory& trajectory, const py::slice& slice) {
  py::ssize_t begin = 0, end = 0, step = 0, count = 0;
  if (!slice.compute(static_cast<py::ssize_t>(trajectory.poses.size()), &begin, &end, &step, &count))
    throw py::error_already_set();
  if (step < 0) throw UsageError("Trajectory: poses are sorted by time; use a slice with a positive step");
  PyTrajectory part;
  for (py::ssize_t i = 0; i < count; ++i)
    part.poses.push_back(trajectory.poses[static_cast<size_t>(begin + i * step)]);
  return part;
}

py::object pose_of(const PyTrajectory& trajectory, py::ssize_t index) {
  const auto size = static_cast<py::ssize_t>(trajectory.poses.size());
  if (index < -size || index >= size)
    throw py::index_error(fmt::format("Trajectory: index {} of {} poses", index, size));
  const StampedPose& pose = trajectory.poses[static_cast<size_t>(index < 0 ? index + size : index)];
  return matrices(PyTrajectory{Trajectory{pose}}).attr("reshape")(4, 4);
}

/// Of a pickled trajectory, exactly as it was: stamp, translation, quaternion x, y, z, w.
using PickledPose = std::pair<int64_t, std::array<double, 7>>;

std::vector<PickledPose> pickled(const PyTrajectory& trajectory) {
  std::vector<PickledPose> poses;
  for (const auto& [stamp_ns, T] : trajectory.poses) {
    const auto& [t, q] = std::pair(T.translation, T.rotation);
    poses.push_back({stamp_ns, {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}});
  }
  return poses;
}

PyTrajectory unpickled(const std::vector<PickledPose>& poses) {
  PyTrajectory trajectory;
  for (const auto& [stamp_ns, p] : poses)
    trajectory.poses.push_back(
        {stamp_ns, SE3{Eigen::Quaterniond(p[6], p[3], p[4], p[5]), {p[0], p[1], p[2]}}});
  return trajectory;
}

void save_trajectory(const PyTrajectory& trajectory, const std::filesystem::path& path) {
  write_trajectory_file(path, trajectory.poses);
}

}  // namespace

TrajectoryFile trajectory_argument(const py::object& argument, const char* name, TrajectoryRole role) {
  if (py::isinstance<PyTrajectory>(argument))
    return {.poses = argument.cast<const PyTrajectory&>().poses, .knows_quaternion_order = true};
  if (!py::isinstance<py::str>(argument) && !py::hasattr(argument, "__fspath__"))
    throw UsageError(fmt::format("{}: expected a Trajectory or the path of one", name));
  const auto path = argument.cast<std::filesystem::path>();
  return role == TrajectoryRole::kEstimate ? open_estimate(path) : open_ground_truth(path);
}

void bind_trajectory(py::module_& module) {
  py::class_<PyTrajectory>(module, "Trajectory", R"(Camera poses sorted by time.

Trajectory(stamps_s, poses): stamps (N,) in seconds and poses (N, 4, 4), T_world_camera in metres: p_world = T @ p_camera.
The camera looks along z, x is right, y is down. Raises UsageError unless every pose is a rigid motion.)")
      .def(py::init([](const Doubles& stamps_s, const Doubles& poses) {
             return PyTrajectory{trajectory_from(stamps_s, poses)};
           }),
           py::arg("stamps_s"), py::arg("poses"))
      .def_static(
          "load", [](const std::filesystem::path& path) { return PyTrajectory{open_estimate(path).poses}; },
          py::arg("path"),
          "Reads TUM, EuRoC or KITTI format, a table with named columns, or the folder of a run. Raises "
          "InputError naming file and line.")
      .def("save", &save_trajectory, py::arg("path"),
           "Writes the TUM format, the same bytes as kinloop run; a name that ends in .csv gives a table "
           "with header, one that ends in .kitti the KITTI format.")
      .def("__len__", [](const PyTrajectory& t) { return t.poses.size(); })
      .def("__getitem__", &pose_of, py::arg("index"), "T_world_camera, float64 (4, 4), metres.")
      .def("__getitem__", &slice_of, py::arg("slice"), "The Trajectory of these poses.")
      .def(py::pickle(&pickled, &unpickled))
      .def_property_readonly(
          "stamps_s",
          [](const PyTrajectory& trajectory) {
            return per_pose<double>(
                trajectory, {}, [](const StampedPose& pose, double* to) { *to = seconds_of(pose.stamp_ns); });
          },
          "Stamps in seconds, float64 (N,).")
      .def_property_readonly(
          "stamps_ns",
          [](const PyTrajectory& trajectory) {
            return per_pose<int64_t>(trajectory, {},
                                     [](const StampedPose& pose, int64_t* to) { *to = pose.stamp_ns; });
          },
          "Stamps in nanoseconds, exact, int64 (N,).")
      .def_property_readonly("poses", &matrices, "T_world_camera, float64 (N, 4, 4), metres.")
      .def_property_readonly(
          "positions",
          [](const PyTrajectory& trajectory) {
            return per_pose<double>(trajectory, {3}, [](const StampedPose& pose, double* to) {
              Eigen::Map<Eigen::Vector3d> position(to);
              position = pose.T_world_camera.translation;
            });
          },
          "Camera centres in the world, float64 (N, 3), metres.")
      .def_property_readonly("quaternions", &quaternions, "Camera rotations as x, y, z, w, float64 (N, 4).")
      .def("__repr__", [](const PyTrajectory& t) {
        if (t.poses.empty()) return std::string("<kinloop.Trajectory: empty>");
        return fmt::format("<kinloop.Trajectory: {} poses in {:.2f} s>", t.poses.size(),
                           to_seconds(t.poses.back().stamp_ns - t.poses.front().stamp_ns));
      });
}

}  // namespace kinloop::python
