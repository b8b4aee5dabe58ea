#pragma once

#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "python/bindings/bindings.hpp"

namespace kinloop::python {

/// Returns the camera of an argument: a Camera, a preset ("freiburg1") or a camera.yaml. Throws UsageError
/// naming the argument for anything else.
RgbdCamera camera_argument(const py::object& argument, const char* name);

}  // namespace kinloop::python
