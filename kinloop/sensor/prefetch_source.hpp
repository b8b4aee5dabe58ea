#pragma once
// In: a source whose frames take time to read and decode. Out: the same frames, read ahead on a thread.

#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "kinloop/base/channel.hpp"
#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// Gives exactly what the wrapped source gives, frame by frame, skipped frames and exceptions included; only
/// sooner. For recorded input: it never drops a frame.
class PrefetchSource : public FrameSource {
 public:
  static constexpr size_t kFramesAhead = 6;

  explicit PrefetchSource(std::unique_ptr<FrameSource> source, size_t frames_ahead = kFramesAhead);

  /// Waits for the frame that is being read, no longer.
  ~PrefetchSource() override;
  PrefetchSource(const PrefetchSource&) = delete;
  PrefetchSource& operator=(const PrefetchSource&) = delete;

  std::optional<RgbdFrame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return source_->camera(); }
  [[nodiscard]] const SourceInfo& info() const override { return source_->info(); }

  /// The frames skipped before the one that `next` gave last; may be called from any thread.
  [[nodiscard]] std::vector<SkippedFrame> skipped() const override;

 private:
  /// What one call of the wrapped `next` gave.
  struct Step {
    std::optional<RgbdFrame> frame;
    std::vector<SkippedFrame> skipped;
    std::exception_ptr error;
  };

  void read_ahead();

  std::unique_ptr<FrameSource> source_;
  mutable std::mutex skipped_mutex_;
  std::vector<SkippedFrame> skipped_;
  Channel<Step> steps_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace kinloop
