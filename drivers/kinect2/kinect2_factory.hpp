#pragma once
// In: the factory calibration stored in a Kinect 2. Out: its cameras. Requires libfreenect2's headers;
// internal to the Kinect 2 driver and its tests.

#include <libfreenect2/libfreenect2.hpp>

#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Returns the factory-calibrated cameras for unmirrored images. libfreenect2's polynomial from depth to
/// colour is replaced by the rigid motion that fits it best.
RgbdCamera factory_camera(const libfreenect2::Freenect2Device::ColorCameraParams& color,
                          const libfreenect2::Freenect2Device::IrCameraParams& infrared);

}  // namespace kinloop
