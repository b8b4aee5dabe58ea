#pragma once
// A Kinect 1 on USB, via libfreenect (optional dependency).

#include <memory>
#include <optional>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether this build supports the Kinect 1.
bool kinect1_available();

/// Opens the first device and starts its streams: colour and depth of 640 x 480, registered to colour by the
/// device's own calibration. The camera is `calibration` if given, else typical Kinect 1 intrinsics, with a
/// warning. Throws InputError if there is no device, and UsageError in a build without libfreenect.
std::unique_ptr<FrameSource> open_kinect1(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
