#include "kinloop/sensor/reconnection.hpp"

#include <thread>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"

namespace kinloop {
namespace {

using Clock = std::chrono::steady_clock;

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

std::optional<RgbdFrame> next_or_reconnect(LiveFrames& frames, const Reconnection& camera) {
  if (auto frame = frames.wait(camera.patience)) return frame;
  log::warn("{}: no frames for {} s: unplugged? Waiting up to {} s for it", camera.name,
            std::chrono::duration<double>(camera.patience).count(), camera.give_up_s);
  const auto until = Clock::now() + std::chrono::duration<double>(camera.give_up_s);
  while (Clock::now() < until) {
    if (!reopened(camera)) {
      std::this_thread::sleep_for(camera.patience / 2);
    } else if (auto frame = frames.wait(camera.patience)) {
      log::warn("{}: it is back", camera.name);
      return frame;
    }
  }
  log::error("{}: the camera is gone; finishing with the frames there are", camera.name);
  return std::nullopt;
}

}  // namespace kinloop
