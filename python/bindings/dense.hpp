#pragma once
// Clouds and meshes in Python: the data and the frame of their files.

#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "kinloop/dense/texture/texture_mesh.hpp"
#include "kinloop/io/file_frame.hpp"

namespace kinloop::python {

struct PyCloud {
  ColoredCloud cloud;
  FileFrame frame;
};

struct PyMesh {
  TexturedMesh made;
  FileFrame frame;
};

}  // namespace kinloop::python
