#pragma once
// Colour and depth arrays to a frame.

#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/slam.hpp"

namespace kinloop::python {

/// How arrays become a frame.
struct ArrayConversion {
  double depth_scale = 1000;  ///< units per metre of integer depth
  bool copy = true;           ///< false: share the memory where layout and values allow it
};

/// Returns the images of the arrays; stamps are left to the caller. Throws UsageError, naming the argument,
/// unless both have the type and size of the camera's images. Called with the GIL, which is released for the
/// work.
ArrayFrame frame_of_arrays(const py::array& rgb, const py::array& depth, const RgbdCamera& camera,
                           const ArrayConversion& conversion);

}  // namespace kinloop::python
