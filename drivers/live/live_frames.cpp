#include "drivers/live/live_frames.hpp"

#include <algorithm>

#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {

void LiveFrameBuffer::add_color(int64_t stamp_ns, ColorImage image) {
  const std::lock_guard lock(mutex_);
  pairer_.add_color(continued(stamp_ns), std::move(image));
  collect_ready();
}

void LiveFrameBuffer::add_depth(int64_t stamp_ns, cv::Mat depth_m, cv::Mat infrared) {
  const std::lock_guard lock(mutex_);
  pairer_.add_depth(continued(stamp_ns), std::move(depth_m), std::move(infrared));
  collect_ready();
}

void LiveFrameBuffer::add_pair(int64_t stamp_ns, ColorImage image, int64_t depth_stamp_ns, cv::Mat depth_m,
                               cv::Mat mask) {
  const std::lock_guard lock(mutex_);
  const int64_t color_ns = continued(stamp_ns);
  pairer_.add_pair(color_ns, std::move(image), shifted(depth_stamp_ns), std::move(depth_m), std::move(mask));
  collect_ready();
}

void LiveFrameBuffer::finish() {
  const std::lock_guard lock(mutex_);
  pairer_.finish();
  collect_ready();
}

int64_t LiveFrameBuffer::continued(int64_t stamp_ns) {
  constexpr int64_t kSecondNs = 1'000'000'000, kPauseNs = 100'000'000;
  stamp_ns = std::clamp(stamp_ns, -kMaxStampNs, kMaxStampNs);
  if (newest_ns_ && stamp_ns + shift_ns_ < *newest_ns_ - kSecondNs) {
    log::warn("the clock of the images was set back by {:.1f} s; stamps continue from before",
              1e-9 * static_cast<double>(*newest_ns_ - shift_ns_ - stamp_ns));
    shift_ns_ = *newest_ns_ + kPauseNs - stamp_ns;
  }
  const int64_t result_ns = shifted(stamp_ns);
  newest_ns_ = std::max(newest_ns_.value_or(result_ns), result_ns);
  return result_ns;
}

int64_t LiveFrameBuffer::shifted(int64_t stamp_ns) const {
  return std::clamp(std::clamp(stamp_ns, -kMaxStampNs, kMaxStampNs) + shift_ns_, -kMaxStampNs, kMaxStampNs);
}

void LiveFrameBuffer::collect_ready() {
  while (auto frame = pairer_.next()) {
    frame->time.read_at = std::chrono::steady_clock::now();
    ready_.push_back(std::move(*frame));
    if (ready_.size() <= capacity_) continue;
    ready_.pop_front();
    ++dropped_;
  }
  if (!ready_.empty()) frame_ready_.notify_one();
}

std::optional<Frame> LiveFrameBuffer::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  if (!frame_ready_.wait_for(lock, timeout, [&] { return !ready_.empty(); })) return std::nullopt;
  Frame frame = std::move(ready_.front());
  ready_.pop_front();
  ++delivered_;
  return frame;
}

size_t LiveFrameBuffer::delivered() const {
  const std::lock_guard lock(mutex_);
  return delivered_;
}

LostImageCounts LiveFrameBuffer::counts() const {
  const std::lock_guard lock(mutex_);
  return {dropped_, pairer_.unpaired(), pairer_.out_of_order()};
}

SkippedFrames to_skipped_frames(const LostImageCounts& counts) {
  SkippedFrames skipped;
  skipped.add({"frame", "dropped: the consumer was too slow"}, counts.dropped);
  skipped.add({"image", "no image of the other camera at that time"}, counts.unpaired);
  skipped.add({"image", "its timestamp does not increase"}, counts.out_of_order);
  return skipped;
}

}  // namespace kinloop
