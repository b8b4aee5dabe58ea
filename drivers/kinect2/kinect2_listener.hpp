#pragma once
// In: libfreenect2's mirrored images. Out: unmirrored images. Requires libfreenect2's headers; internal to
// the Kinect 2 driver and its tests.

#include <atomic>

#include <libfreenect2/frame_listener.hpp>

#include "drivers/live/device_clock.hpp"
#include "drivers/live/live_frames.hpp"

namespace kinloop {

/// Copies and unmirrors libfreenect2's frames. Colour is scaled down to `color_width`; infrared is passed on
/// with the depth image if `wanted`; frames that the driver marks as faulty are counted.
class Kinect2Listener : public libfreenect2::FrameListener {
 public:
  Kinect2Listener(LiveFrameBuffer& frames, int color_width, bool with_infrared = false)
      : frames_(frames), color_width_(color_width), with_infrared_(with_infrared) {}
  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override;

  /// Must be called before a reopened device starts, since its clock starts anew.
  void restart_clock() { clock_.restart(); }

  [[nodiscard]] size_t faulty() const { return faulty_; }

 private:
  static constexpr double kNsPerTick = 125'000;

  void on_color(int64_t stamp_ns, const libfreenect2::Frame& frame);
  void on_depth(int64_t stamp_ns, const libfreenect2::Frame& frame);
  void on_infrared(const libfreenect2::Frame& frame);

  LiveFrameBuffer& frames_;
  int color_width_;
  bool with_infrared_;
  cv::Mat infrared_;  ///< of the next depth image, which arrives on the same thread
  DeviceClock clock_{kNsPerTick};
  std::atomic<size_t> faulty_ = 0;
};

}  // namespace kinloop
