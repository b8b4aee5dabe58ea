#pragma once
// A Kinect 2 on USB, through libfreenect2. Only where the build found it.

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// Whether this build knows the Kinect 2.
bool kinect2_available();

/// Opens it and starts its streams. Its camera is `calibration` (with its depth camera) where given, else
/// what the factory wrote into the device. Colour is given as the world is, not mirrored, and depth
/// registered to it, or kept separate. Throws InputError where there is none or it cannot be opened, and
/// UsageError in a build without libfreenect2.
std::unique_ptr<FrameSource> open_kinect2(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration,
                                          Kinect2Frames frames = Kinect2Frames::kRegistered);

}  // namespace kinloop
