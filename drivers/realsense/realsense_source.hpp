#pragma once
// A RealSense camera on USB, via librealsense2 (optional dependency).

#include <memory>
#include <optional>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether this build supports RealSense cameras.
bool realsense_available();

/// Opens the device with the serial number `options.serial`, or the first one, and starts colour in the mode
/// nearest to `options.width` and 30 Hz, and depth. The camera is `calibration` (with its depth camera) if
/// given, else that of the device. Depth is registered to colour by kinloop. Throws InputError if there is no
/// such device or it cannot be opened, and UsageError in a build without librealsense2.
std::unique_ptr<FrameSource> open_realsense(const KinectOptions& options,
                                            const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
