#pragma once
// In: a camera that may be unplugged. Out: its frames, also after it is plugged in again.

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "drivers/live/live_frames.hpp"

namespace kinloop {

/// How to reopen a camera that no longer sends frames.
struct Reconnection {
  std::string name;                     ///< in messages
  std::chrono::milliseconds timeout{};  ///< without a frame, after which the camera counts as unplugged
  double max_wait_s = 0;                ///< maximum time to wait for its return
  std::function<void()> close;
  std::function<void()> open;  ///< throws InputError if there is no camera
  StopRequest stop = {};       ///< ends the wait for its return
};

/// Returns the next frame of the camera that fills `frames`. If none arrives, closes and reopens the camera
/// until one does; nullopt if it did not return or `stop` said so.
std::optional<Frame> next_or_reconnect(LiveFrameBuffer& frames, const Reconnection& camera);

}  // namespace kinloop
