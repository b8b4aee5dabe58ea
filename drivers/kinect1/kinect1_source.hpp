#pragma once
// A Kinect 1 on USB, through libfreenect. Only where the build found it.

#include <memory>
#include <optional>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// Whether this build knows the Kinect 1.
bool kinect1_available();

/// Opens the first one and starts its streams: colour and depth of 640 x 480, which the device's own
/// calibration registers to colour. The camera is `calibration` where given, else the usual one of a Kinect
/// 1, with a warning. Throws InputError where there is none, and UsageError in a build without libfreenect.
std::unique_ptr<FrameSource> open_kinect1(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
