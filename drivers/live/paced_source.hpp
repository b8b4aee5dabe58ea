#pragma once
// In: a recorded sequence. Out: its frames at the rate of a camera: none before its time, and frames not
// taken in time are lost. Used to measure which rate a run keeps up with.

#include <functional>
#include <memory>

#include "kinloop/sensor/source/forwarding_source.hpp"

namespace kinloop {

/// The clock that paces the frames, seconds.
struct PaceClock {
  std::function<double()> now_s;
  std::function<void(double)> sleep_until_s;

  /// The steady wall clock.
  static PaceClock steady();
};

/// Frame n arrives n / rate_hz after the first request. Like a driver it buffers the latest kBuffered frames
/// and drops older ones. (Dropped frames are decoded all the same, slightly more load than a real camera.)
class PacedSource : public ForwardingSource {
 public:
  static constexpr size_t kBuffered = 4;

  PacedSource(std::unique_ptr<FrameSource> source, double rate_hz, PaceClock clock = PaceClock::steady());

  std::optional<Frame> next() override;
  [[nodiscard]] const SourceInfo& info() const override { return info_; }

  /// Number of frames that arrived but were not taken.
  [[nodiscard]] size_t dropped() const { return dropped_; }

 private:
  SourceInfo info_;
  double rate_hz_;
  PaceClock clock_;
  std::optional<double> start_s_;
  size_t next_index_ = 0;
  size_t dropped_ = 0;
};

}  // namespace kinloop
