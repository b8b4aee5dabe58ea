#pragma once
// In: what the factory wrote into a Kinect 2. Out: its cameras. Needs libfreenect2's headers: for the
// Kinect 2's own files and their tests only.

#include <libfreenect2/libfreenect2.hpp>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// The cameras as the factory measured them, for images that are not mirrored. libfreenect2's polynomial from
/// depth to colour becomes the rigid motion that fits it best.
RgbdCamera factory_camera(const libfreenect2::Freenect2Device::ColorCameraParams& color,
                          const libfreenect2::Freenect2Device::IrCameraParams& infrared);

}  // namespace kinloop
