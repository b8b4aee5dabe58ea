#pragma once

#include "python/bindings/slam.hpp"
#include "python/bindings/trajectory.hpp"

namespace kinloop::python {

/// The result of a run.
struct Result {
  std::shared_ptr<Run> run;
  PyTrajectory trajectory;
  DoubtfulPoses doubtful = DoubtfulPoses::kLeftOut;  ///< in `trajectory`
  py::object cloud;                                  ///< a PyCloud once it has been asked for, else None
};

/// Returns where the input of a run contradicts itself, as in run.json.
py::list warnings_of(Run& run);

}  // namespace kinloop::python
