#pragma once
// In: the counter that a camera stamps its images with. Out: time stamps.

#include <cstdint>
#include <mutex>
#include <optional>

namespace kinloop {

/// Stamps by a device's counter of 32 bits, which wraps around: the first is the time of day, all others
/// follow the counter, forwards and backwards. Safe to ask from several threads.
class DeviceClock {
 public:
  explicit DeviceClock(double ns_per_tick) : ns_per_tick_(ns_per_tick) {}

  int64_t stamp_ns(uint32_t ticks);

  /// The device was opened anew and counts from somewhere else: the next stamp is the time of day again.
  void restart();

 private:
  double ns_per_tick_;
  std::mutex mutex_;
  std::optional<uint32_t> last_ticks_;
  int64_t start_ns_ = 0;  ///< the time of day at the first stamp
  int64_t ticks_since_ = 0;
};

}  // namespace kinloop
