#pragma once
// In: images from a driver's thread. Out: frames for the mapping thread; the oldest are dropped if it is too
// slow.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "drivers/live/frame_pairer.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Images that a live camera lost, by cause.
struct LostImageCounts {
  size_t dropped = 0;       ///< frames not taken in time
  size_t unpaired = 0;      ///< images without a partner from the other camera
  size_t out_of_order = 0;  ///< images with a stamp not after the previous one
};

/// One thread may fill it while another empties it. When the clock of the images is set back by more than a
/// second, as by a time server or a bag played again, stamps go on from the newest one; smaller steps back
/// are images out of order.
class LiveFrameBuffer {
 public:
  static constexpr size_t kBuffered = 4;

  explicit LiveFrameBuffer(size_t capacity = kBuffered) : capacity_(capacity) {}

  void add_color(int64_t stamp_ns, ColorImage image);
  void add_depth(int64_t stamp_ns, cv::Mat depth_m, cv::Mat infrared = {});
  void add_pair(int64_t stamp_ns, ColorImage image, int64_t depth_stamp_ns, cv::Mat depth_m,
                cv::Mat mask = {});

  /// No more images will arrive: pairs those that wait for a nearer partner.
  void finish();

  /// Returns the oldest frame, waiting for one if necessary; nullopt after `timeout`.
  std::optional<Frame> wait(std::chrono::milliseconds timeout);

  [[nodiscard]] LostImageCounts counts() const;

  /// Number of frames that `wait` returned.
  [[nodiscard]] size_t delivered() const;

 private:
  void collect_ready();
  int64_t continued(int64_t stamp_ns);
  /// Adds the shift. Impossible stamps become the last possible one: they no longer increase.
  [[nodiscard]] int64_t shifted(int64_t stamp_ns) const;

  size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable frame_ready_;
  FramePairer pairer_;
  std::deque<Frame> ready_;
  size_t dropped_ = 0, delivered_ = 0;
  int64_t shift_ns_ = 0;  ///< added to all stamps since the clock was set back
  std::optional<int64_t> newest_ns_;
};

/// Converts the lost images to the form of `FrameSource::skipped`.
SkippedFrames to_skipped_frames(const LostImageCounts& counts);

}  // namespace kinloop
