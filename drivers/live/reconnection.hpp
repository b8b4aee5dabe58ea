#pragma once
// In: a camera that may be unplugged. Out: its frames, also after it was plugged in again.

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "drivers/live/live_frames.hpp"

namespace kinloop {

/// How a camera is opened again that gives no frames any more.
struct Reconnection {
  std::string name;                     ///< in messages
  std::chrono::milliseconds timeout{};  ///< without a frame: then it counts as unplugged
  double max_wait_s = 0;                ///< how long to wait for it
  std::function<void()> close;
  std::function<void()> open;  ///< throws InputError where there is none
};

/// The next frame of the camera that fills `frames`. When none comes it is closed and opened until one does;
/// nothing when it did not come back.
std::optional<RgbdFrame> next_or_reconnect(LiveFrameBuffer& frames, const Reconnection& camera);

}  // namespace kinloop
