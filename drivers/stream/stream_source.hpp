#pragma once
// In: standard input or a Unix socket, into which another program writes frames. Out: its frames.

#include <memory>
#include <optional>
#include <string>

#include "drivers/stream/frame_protocol.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns whether `sequence` names a stream: "-" or "unix:PATH".
bool is_stream(const std::string& sequence);

/// Waits for the beginning of the stream. The camera is `camera` if given, else that of the stream. A live
/// stream is read continuously and loses frames that are not taken in time; another one waits for its
/// consumer. Frames whose images cannot be decoded are skipped and counted. Throws InputError naming stream
/// and record, also from `next`, if the stream does not follow the protocol.
std::unique_ptr<FrameSource> open_stream(const std::string& sequence, const std::optional<RgbdCamera>& camera,
                                         const StopRequest& stop = {});

/// Same for bytes from elsewhere.
std::unique_ptr<FrameSource> open_stream(ByteStream bytes, const std::string& name,
                                         const std::optional<RgbdCamera>& camera,
                                         const StopRequest& stop = {});

}  // namespace kinloop
