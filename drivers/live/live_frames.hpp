#pragma once
// In: images from a driver's thread. Out: frames for the thread that maps; the oldest are lost where it is
// too slow.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "drivers/live/frame_pairer.hpp"
#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// Images that a live camera lost, by how.
struct LostImageCounts {
  size_t dropped = 0;       ///< frames that nobody took in time
  size_t unpaired = 0;      ///< images without one of the other camera
  size_t out_of_order = 0;  ///< images whose stamp was not after the one before
};

/// Safe to fill from one thread and to empty from another.
class LiveFrameBuffer {
 public:
  static constexpr size_t kBuffered = 4;

  explicit LiveFrameBuffer(size_t capacity = kBuffered) : capacity_(capacity) {}

  void add_color(int64_t stamp_ns, cv::Mat image);
  void add_depth(int64_t stamp_ns, cv::Mat depth_m, cv::Mat infrared = {});

  /// The oldest frame there is; waits for one, nothing when `timeout` has passed.
  std::optional<RgbdFrame> wait(std::chrono::milliseconds timeout);

  [[nodiscard]] LostImageCounts counts() const;

  /// Frames that `wait` gave.
  [[nodiscard]] size_t delivered() const;

 private:
  void collect_ready();

  size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable frame_ready_;
  FramePairer pairer_;
  std::deque<RgbdFrame> ready_;
  size_t dropped_ = 0, delivered_ = 0;
};

/// What `FrameSource::skipped` says of the images that were lost.
std::vector<SkippedFrame> to_skipped_frames(const LostImageCounts& counts);

}  // namespace kinloop
