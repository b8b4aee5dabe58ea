#pragma once

#include "tools/export/g2o/g2o_file.hpp"

namespace kinloop::python {

/// A pose graph as a Python object.
struct PyPoseGraph {
  G2oFile file;
};

}  // namespace kinloop::python
