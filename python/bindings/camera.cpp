#include "python/bindings/camera.hpp"

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "drivers/datasets/camera_selection.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"

namespace kinloop::python {
namespace {

/// Numbers and arrays of NumPy as those of Python.
py::object plain(const py::object& value) {
  if (py::hasattr(value, "tolist")) return value.attr("tolist")();
  throw py::type_error("Camera: expected numbers, lists and dicts");
}

/// Reads the keywords as a camera file in JSON, so that all checks and texts are those of camera.yaml.
RgbdCamera camera_of_keywords(const py::kwargs& keys) {
  py::dict all;
  if (!keys.contains("model")) all["distortion"] = py::make_tuple(0, 0, 0, 0, 0);
  all["depth_scale"] = RgbdCamera().depth_scale;
  all["fps"] = RgbdCamera().fps;
  for (const auto& [key, value] : keys) all[key] = value;
  const py::object text =
      py::module_::import("json").attr("dumps")(all, py::arg("default") = py::cpp_function(&plain));
  return read_camera_text(text.cast<std::string>(), "Camera");
}

Eigen::Matrix3d intrinsics(const RgbdCamera& camera) {
  const PinholeCamera& c = camera.color;
  return Eigen::Matrix3d{{c.fx, 0, c.cx}, {0, c.fy, c.cy}, {0, 0, 1}};
}

std::string camera_text(const RgbdCamera& camera) {
  const PinholeCamera& c = camera.color;
  return fmt::format("<kinloop.Camera: {}x{}, fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f}, {}>", c.width,
                     c.height, c.fx, c.fy, c.cx, c.cy, name_of(camera.sensor.model));
}

template <class Class, class T>
void add_number(Class& bound, const char* name, T PinholeCamera::*field, const char* doc) {
  bound.def_property_readonly(
      name, [field](const RgbdCamera& camera) { return camera.color.*field; }, doc);
}

using CameraClass = py::class_<RgbdCamera>;

void add_properties(CameraClass& camera) {
  add_number(camera, "width", &PinholeCamera::width, "Width of the colour image, px.");
  add_number(camera, "height", &PinholeCamera::height, "Height of the colour image, px.");
  add_number(camera, "fx", &PinholeCamera::fx, "Focal length along x, px.");
  add_number(camera, "fy", &PinholeCamera::fy, "Focal length along y, px.");
  add_number(camera, "cx", &PinholeCamera::cx,
             "Principal point, px; (0, 0) is the centre of the top left pixel.");
  add_number(camera, "cy", &PinholeCamera::cy, "Principal point, px.");
  camera.def_property_readonly("K", &intrinsics, "The matrix of intrinsics, float64 (3, 3).")
      .def_property_readonly(
          "model", [](const RgbdCamera& c) { return std::string(name_of(c.color.lens.model)); },
          "Lens model: brown_conrady, rational or kannala_brandt.")
      .def_property_readonly(
          "distortion", [](const RgbdCamera& c) { return lens_coefficients(c.color.lens); },
          "Coefficients in OpenCV's order: k1 k2 p1 p2 k3 (rational: k4 k5 k6 too; kannala_brandt: k1 k2 k3 "
          "k4).")
      .def_property_readonly(
          "sensor", [](const RgbdCamera& c) { return std::string(name_of(c.sensor.model)); },
          "The depth sensor, which gives the noise and range of depth: kinect1, kinect2, realsense_d4xx, ...")
      .def_readonly("depth_scale", &RgbdCamera::depth_scale, "Units of a uint16 depth image per metre.")
      .def_readonly("depth_shift_m", &RgbdCamera::depth_shift_m, "Added to every measured depth, metres.")
      .def_readonly("fps", &RgbdCamera::fps, "Frames per second.")
      .def_readonly(
          "rolling_shutter_s", &RgbdCamera::rolling_shutter_s,
          "Readout time from the first colour row to the last, seconds; None if unknown: that typical of the "
          "sensor is used.")
      .def_readonly("depth_offset_s", &RgbdCamera::depth_delay_s,
                    "Time of the depth measurement minus its stamp, seconds.");
}

}  // namespace

RgbdCamera camera_argument(const py::object& argument, const char* name) {
  if (py::isinstance<RgbdCamera>(argument)) return argument.cast<RgbdCamera>();
  if (!py::isinstance<py::str>(argument) && !py::hasattr(argument, "__fspath__"))
    throw UsageError(
        fmt::format("{}: expected a Camera, the name of a preset or the path of a camera.yaml", name));
  return given_camera(argument.cast<std::filesystem::path>().string());
}

void bind_camera(py::module_& module) {
  CameraClass camera(module, "Camera", R"(The calibration of an RGB-D camera, the content of camera.yaml.

Camera(width, height, fx, fy, cx, cy, distortion=..., depth_scale=5000, fps=30, ...): the keys of camera.yaml as
keywords, see docs/cameras.md. Depth that is not registered to colour has depth={fx, fy, cx, cy, distortion} and
T_color_depth={translation, rotation_vector}. Raises InputError, which names the key and what was expected.)");
  camera.def(py::init(&camera_of_keywords))
      .def_static("from_yaml", &read_camera_file, py::arg("path"),
                  "Reads camera.yaml. Raises InputError naming file, line, key and remedy.")
      .def_static(
          "preset", [](const std::string& name) { return given_camera(name); }, py::arg("name"),
          "Returns a published calibration: freiburg1, freiburg2, freiburg3 (TUM RGB-D) or icl (ICL-NUIM).")
      .def(
          "save", [](const RgbdCamera& c, const std::filesystem::path& path) { write_camera_file(path, c); },
          py::arg("path"), "Writes camera.yaml.")
      .def("to_yaml", &camera_file_text, "Returns the text of camera.yaml.")
      .def(
          "__eq__",
          [](const RgbdCamera& a, const RgbdCamera& b) { return camera_file_text(a) == camera_file_text(b); },
          py::is_operator())
      .def("__repr__", &camera_text)
      .def(py::pickle([](const RgbdCamera& c) { return camera_file_text(c); },
                      [](const std::string& text) { return read_camera_text(text, "Camera"); }));
  add_properties(camera);
}

}  // namespace kinloop::python
