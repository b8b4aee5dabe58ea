#include "drivers/live/reconnection.hpp"

#include <thread>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

using Clock = std::chrono::steady_clock;

bool stopped(const Reconnection& camera) {
  return camera.stop && camera.stop();
}

bool reopened(const Reconnection& camera) {
  camera.close();
  try {
    camera.open();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

std::optional<Frame> next_or_reconnect(LiveFrameBuffer& frames, const Reconnection& camera) {
  if (auto frame = frames.wait(camera.timeout)) return frame;
  if (stopped(camera)) return std::nullopt;
  log::warn("{}: no frames for {} s; waiting up to {} s for the camera to return", camera.name,
            std::chrono::duration<double>(camera.timeout).count(), camera.max_wait_s);
  const auto until = Clock::now() + std::chrono::duration<double>(camera.max_wait_s);
  while (Clock::now() < until && !stopped(camera)) {
    if (!reopened(camera)) {
      std::this_thread::sleep_for(camera.timeout / 2);
    } else if (auto frame = frames.wait(camera.timeout)) {
      log::warn("{}: reconnected", camera.name);
      return frame;
    }
  }
  if (!stopped(camera))
    log::error("{}: the camera did not return; finishing with the frames received", camera.name);
  return std::nullopt;
}

}  // namespace kinloop
