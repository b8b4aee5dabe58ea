#pragma once
// A camera with an OpenNI 2 driver (Xtion, Astra, Structure Core, Kinect 1), via libOpenNI2 (optional
// dependency).

#include <memory>
#include <optional>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether this build supports OpenNI 2.
bool openni2_available();

/// Opens the device with the URI `options.serial`, or the first one, and starts its streams of colour and
/// depth. Depth is registered to colour by the device, in synchronous frames if the device can. The camera is
/// `calibration` if given, else that of colour's field of view, with a warning. Throws InputError if there is
/// no such device, and UsageError in a build without libOpenNI2.
std::unique_ptr<FrameSource> open_openni2(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
