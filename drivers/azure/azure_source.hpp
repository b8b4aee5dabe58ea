#pragma once
// In: a recording (.mkv) of the Azure Kinect SDK, also of Orbbec's Femto. Out: its frames.

#include <filesystem>
#include <memory>
#include <optional>

#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Opens a recording with tracks COLOR (MJPG, YUY2 or NV12) and DEPTH (16 bits, millimetres). The cameras are
/// those of the factory calibration attached to the file unless `camera` is given; depth is registered to
/// colour. Damaged images are skipped and counted. Throws InputError if the file is not such a recording or
/// lacks its calibration, and UsageError in a build without libavformat.
std::unique_ptr<FrameSource> open_azure_recording(const std::filesystem::path& path,
                                                  const std::optional<RgbdCamera>& camera);

}  // namespace kinloop
