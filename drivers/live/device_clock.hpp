#pragma once
// In: the counter values that a camera stamps its images with. Out: time stamps.

#include <cstdint>
#include <mutex>
#include <optional>

namespace kinloop {

/// Converts a device's 32-bit counter, which wraps around, to stamps: the first is the time of day, all
/// others follow the counter, forwards and backwards. Thread-safe.
class DeviceClock {
 public:
  explicit DeviceClock(double ns_per_tick) : ns_per_tick_(ns_per_tick) {}

  int64_t stamp_ns(uint32_t ticks);

  /// To be called after the device was reopened and its counter restarted: the next stamp is the time of day
  /// again.
  void restart();

 private:
  double ns_per_tick_;
  std::mutex mutex_;
  std::optional<uint32_t> last_ticks_;
  int64_t start_ns_ = 0;  ///< time of day at the first stamp
  int64_t ticks_since_ = 0;
};

}  // namespace kinloop
