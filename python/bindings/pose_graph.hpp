#pragma once

#include "kinloop/optimize/pose_graph/g2o_file/g2o_file.hpp"

namespace kinloop::python {

/// A pose graph as a Python object.
struct PyPoseGraph {
  G2oFile file;
};

}  // namespace kinloop::python
