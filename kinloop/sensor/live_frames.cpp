#include "kinloop/sensor/live_frames.hpp"

namespace kinloop {

void LiveFrames::add_color(int64_t stamp_ns, cv::Mat image) {
  const std::lock_guard lock(mutex_);
  pairer_.add_color(stamp_ns, std::move(image));
  take_ready();
}

void LiveFrames::add_depth(int64_t stamp_ns, cv::Mat depth_m, cv::Mat infrared) {
  const std::lock_guard lock(mutex_);
  pairer_.add_depth(stamp_ns, std::move(depth_m), std::move(infrared));
  take_ready();
}

void LiveFrames::take_ready() {
  while (auto frame = pairer_.next()) {
    ready_.push_back(std::move(*frame));
    if (ready_.size() <= capacity_) continue;
    ready_.pop_front();
    ++dropped_;
  }
  if (!ready_.empty()) came_.notify_one();
}

std::optional<RgbdFrame> LiveFrames::wait(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (!came_.wait_for(lock, patience, [&] { return !ready_.empty(); })) return std::nullopt;
  RgbdFrame frame = std::move(ready_.front());
  ready_.pop_front();
  ++given_;
  return frame;
}

size_t LiveFrames::given() const {
  const std::lock_guard lock(mutex_);
  return given_;
}

LiveCounts LiveFrames::counts() const {
  const std::lock_guard lock(mutex_);
  return {dropped_, pairer_.unpaired(), pairer_.late()};
}

std::vector<SkippedFrame> skipped_of(const LiveCounts& counts) {
  std::vector<SkippedFrame> skipped;
  skipped.insert(skipped.end(), counts.dropped, {"frame", "not taken in time"});
  skipped.insert(skipped.end(), counts.unpaired, {"image", "no image of the other camera at that time"});
  skipped.insert(skipped.end(), counts.late, {"image", "its time stamp repeats the one before or goes back"});
  return skipped;
}

}  // namespace kinloop
