#pragma once

#include "python/bindings/bindings.hpp"
#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop::python {

/// A trajectory as a Python object (pybind11 would copy a plain vector to a list).
struct PyTrajectory {
  Trajectory poses;
};

/// Which of the trajectories of a folder is meant.
enum class TrajectoryRole { kEstimate, kTruth };

/// Returns the trajectory of an argument: a Trajectory, or the path of a file or folder. Throws UsageError,
/// naming the argument, for anything else.
TrajectoryFile trajectory_argument(const py::object& argument, const char* name, TrajectoryRole role);

}  // namespace kinloop::python
