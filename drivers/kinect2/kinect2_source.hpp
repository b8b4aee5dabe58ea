#pragma once
// A Kinect 2 on USB, via libfreenect2 (optional dependency).

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether this build supports the Kinect 2.
bool kinect2_available();

/// Opens the device and starts its streams. Its camera is `calibration` (with its depth camera) if given,
/// else the factory calibration. Images are not mirrored; depth is registered to colour or kept separate.
/// Throws InputError if there is no device or it cannot be opened, and UsageError in a build without
/// libfreenect2.
std::unique_ptr<FrameSource> open_kinect2(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
