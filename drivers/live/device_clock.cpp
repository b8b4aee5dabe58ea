#include "drivers/live/device_clock.hpp"

#include <chrono>
#include <cmath>

namespace kinloop {

int64_t DeviceClock::stamp_ns(uint32_t ticks) {
  const std::lock_guard lock(mutex_);
  if (!last_ticks_) {
    start_ns_ = std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    ticks_since_ = 0;
  } else {
    // The shorter way round the counter, since images of two streams arrive in either order.
    ticks_since_ += static_cast<int32_t>(ticks - *last_ticks_);
  }
  last_ticks_ = ticks;
  return start_ns_ + std::llround(ns_per_tick_ * static_cast<double>(ticks_since_));
}

void DeviceClock::restart() {
  const std::lock_guard lock(mutex_);
  last_ticks_.reset();
}

}  // namespace kinloop
