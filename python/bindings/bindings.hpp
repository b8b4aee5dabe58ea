#pragma once
// The Python module: one function per topic adds its classes and functions. Docstrings here are the reference
// of the package; python/kinloop/_kinloop.pyi repeats the signatures for type checkers.

#include <pybind11/pybind11.h>

namespace kinloop::python {

namespace py = pybind11;

void bind_camera(py::module_& module);
void bind_trajectory(py::module_& module);
void bind_source(py::module_& module);
void bind_dense(py::module_& module);
void bind_pose_graph(py::module_& module);
void bind_slam(py::module_& module);
void bind_result(py::module_& module);
void bind_map_file(py::module_& module);
void bind_evaluation(py::module_& module);
void bind_places(py::module_& module);
void bind_calibration(py::module_& module);
void bind_viewer(py::module_& module);

}  // namespace kinloop::python
