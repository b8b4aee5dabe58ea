#pragma once
// In: a recording (.oni) of OpenNI. Out: its frames.

#include <filesystem>
#include <memory>
#include <optional>

#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Opens a recording of colour and depth. The camera is `camera` if given, else that of colour's field of
/// view in the file, without distortion; depth is taken for registered to colour unless `camera` has a depth
/// camera. Mirrored images are unmirrored. Damaged images are skipped and counted. Throws InputError if the
/// file is not such a recording or not one frame is usable.
std::unique_ptr<FrameSource> open_oni_recording(const std::filesystem::path& path,
                                                const std::optional<RgbdCamera>& camera);

}  // namespace kinloop
