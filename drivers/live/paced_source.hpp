#pragma once
// In: a recorded sequence. Out: its frames at the pace of a camera: none before its time, and those that
// nobody took in time are lost. For measuring what a run keeps up with.

#include <functional>
#include <memory>

#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// The clock that frames are paced by, seconds.
struct PaceClock {
  std::function<double()> now_s;
  std::function<void(double)> sleep_until_s;

  /// The clock on the wall.
  static PaceClock steady();
};

/// Frame n comes n / rate_hz after the first was asked for. Like a driver it holds the latest kBuffered
/// frames that have come and drops those before them. (Dropped frames are decoded all the same: a little
/// harder than life.)
class PacedSource : public FrameSource {
 public:
  static constexpr size_t kBuffered = 4;

  PacedSource(std::unique_ptr<FrameSource> source, double rate_hz, PaceClock clock = PaceClock::steady());

  std::optional<RgbdFrame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return source_->camera(); }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] std::vector<SkippedFrame> skipped() const override { return source_->skipped(); }

  /// Frames that came and were not taken.
  [[nodiscard]] size_t dropped() const { return dropped_; }

 private:
  std::unique_ptr<FrameSource> source_;
  SourceInfo info_;
  double rate_hz_;
  PaceClock clock_;
  std::optional<double> start_s_;
  size_t next_index_ = 0;
  size_t dropped_ = 0;
};

}  // namespace kinloop
