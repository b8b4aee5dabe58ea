#pragma once
// In: an MCAP file written by `kinloop record`. Out: the frames that were recorded.

#include <filesystem>
#include <memory>
#include <optional>

#include "drivers/bags/message_file.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether the file is a recording of kinloop, by its topics.
bool is_own_recording(const MessageFile& file);

/// The camera is `camera` if given, else that of the recording. Damaged frames are skipped and counted.
/// Throws InputError if the recording has no camera.
std::unique_ptr<FrameSource> open_own_recording(std::unique_ptr<MessageFile> file,
                                                const std::filesystem::path& path,
                                                const std::optional<RgbdCamera>& camera);

}  // namespace kinloop
