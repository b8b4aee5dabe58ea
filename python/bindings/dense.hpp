#pragma once
// Clouds and meshes in Python: the data and the frame of their files.

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"
#include "dense/texture/texture_mesh.hpp"

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
