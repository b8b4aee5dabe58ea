#include "drivers/stream/stream_source.hpp"

#include <atomic>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/images/first_reason.hpp"
#include "drivers/live/live_frames.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kSocketPrefix = "unix:";
constexpr std::chrono::milliseconds kLookInterval(100);

class StreamSource : public FrameSource {
 public:
  StreamSource(ByteStream bytes, const std::string& name, const std::optional<RgbdCamera>& camera,
               StopRequest stop)
      : protocol_(std::move(bytes), name), stop_(std::move(stop)) {
    const StreamStart start = protocol_.read_start([this] { return stopped(); });
    if (!camera && !start.camera)
      throw InputError(fmt::format(
          "{}: the stream has no camera; send \"camera\" in its first record or use --camera FILE", name));
    camera_ = camera ? *camera : *start.camera;
    preparation_.emplace(camera_);
    info_.name = name;
    info_.live = start.live;
    if (info_.live) thread_ = std::jthread([this](const std::stop_token& token) { read_all(token); });
  }

  std::optional<Frame> next() override {
    while (true) {
      const bool ended = ended_;
      if (auto frame = frames_.wait(info_.live && !ended ? kLookInterval : std::chrono::milliseconds(0)))
        return with_registered_depth(std::move(*frame));
      if (ended) break;
      if (!info_.live) read_one([this] { return stopped(); });
    }
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    if (frames_.delivered() == 0 && !stopped())
      throw InputError(fmt::format("{}: no usable frame{}", info_.name, first_reason(skipped())));
    return std::nullopt;
  }

  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override {
    auto all = to_skipped_frames(frames_.counts());
    const std::lock_guard lock(mutex_);
    all.add(skipped_);
    return all;
  }

 private:
  [[nodiscard]] bool stopped() const { return stop_ && stop_(); }

  void read_all(const std::stop_token& stop) {
    while (!ended_) read_one([&] { return stop.stop_requested() || stopped(); });
  }

  /// Passes the next frame on, or notes the end of the stream and why.
  void read_one(const StopRequest& stop) {
    try {
      const auto sent = protocol_.read_frame(stop);
      if (sent) return add(*sent);
    } catch (...) {  // also of the system and of OpenCV: `next` rethrows it
      failure_ = std::current_exception();
    }
    ended_ = true;
  }

  void add(const SentFrame& sent) {
    try {
      const PinholeCamera& depth_camera = camera_.depth ? *camera_.depth : camera_.color;
      ColorImage color = decode_sent_color(sent.color, camera_.color);
      cv::Mat depth_m = decode_sent_depth(sent.depth, depth_camera, camera_.depth_scale);
      cv::Mat mask = sent.mask ? decode_sent_mask(*sent.mask, camera_.color) : cv::Mat();
      frames_.add_pair(sent.stamp_ns, std::move(color), sent.depth_stamp_ns, std::move(depth_m),
                       std::move(mask));
    } catch (const InputError& error) {
      const std::lock_guard lock(mutex_);
      skipped_.add({fmt::format("frame at {} ns", sent.stamp_ns), error.what()});
    }
  }

  [[nodiscard]] Frame with_registered_depth(Frame frame) {
    frame.depth_m = (*preparation_)(frame.depth_m);
    return frame;
  }

  FrameProtocol protocol_;
  StopRequest stop_;
  SourceInfo info_;
  RgbdCamera camera_;
  std::optional<DepthPreparation> preparation_;
  LiveFrameBuffer frames_;
  mutable std::mutex mutex_;
  SkippedFrames skipped_;       ///< guarded by the mutex
  std::exception_ptr failure_;  ///< written before ended_
  std::atomic<bool> ended_ = false;
  std::jthread thread_;  ///< declared last: it fills the frames
};

}  // namespace

bool is_stream(const std::string& sequence) {
  return sequence == "-" || sequence.starts_with(kSocketPrefix);
}

std::unique_ptr<FrameSource> open_stream(const std::string& sequence, const std::optional<RgbdCamera>& camera,
                                         const StopRequest& stop) {
  if (sequence == "-") return open_stream(open_standard_input(), sequence, camera, stop);
  return open_stream(accept_connection(sequence.substr(kSocketPrefix.size()), stop), sequence, camera, stop);
}

std::unique_ptr<FrameSource> open_stream(ByteStream bytes, const std::string& name,
                                         const std::optional<RgbdCamera>& camera, const StopRequest& stop) {
  return std::make_unique<StreamSource>(std::move(bytes), name, camera, stop);
}

}  // namespace kinloop
