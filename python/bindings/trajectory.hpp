#pragma once

#include "kinloop/geometry/trajectory.hpp"
#include "python/bindings/bindings.hpp"

namespace kinloop::python {

/// A trajectory as a Python object (pybind11 would copy a plain vector to a list).
struct PyTrajectory {
  Trajectory poses;
};

/// Returns the trajectory of an argument: a Trajectory, or the path of a file in TUM format. Throws
/// UsageError, naming the argument, for anything else.
Trajectory trajectory_argument(const py::object& argument, const char* name);

}  // namespace kinloop::python
