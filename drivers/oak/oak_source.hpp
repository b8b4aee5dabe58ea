#pragma once
// An OAK camera on USB or Ethernet, via depthai 3 (optional dependency).

#include <memory>
#include <optional>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether this build supports OAK cameras.
bool oak_available();

/// Opens the device with the id `options.serial`, or the first one, and starts colour with `options.width`
/// pixels of width at 30 Hz. The device removes the distortion of colour and registers depth to it. The
/// camera is `calibration` if given, else that of the device. Throws InputError if there is no such device or
/// it cannot be opened, and UsageError in a build without depthai.
std::unique_ptr<FrameSource> open_oak(const KinectOptions& options,
                                      const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
