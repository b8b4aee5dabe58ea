#pragma once
// In: images as libfreenect2 gives them. Out: images as the world is. Needs libfreenect2's headers: for the
// Kinect 2's own files and their tests only.

#include <atomic>

#include <libfreenect2/frame_listener.hpp>

#include "drivers/live/device_clock.hpp"
#include "drivers/live/live_frames.hpp"

namespace kinloop {

/// Takes libfreenect2's frames, which are mirrored, and hands on copies of them that are not. Colour is made
/// smaller to `color_width`; infrared is handed on with the depth image where it is `wanted`; frames that the
/// driver marks as faulty are counted.
class Kinect2Listener : public libfreenect2::FrameListener {
 public:
  Kinect2Listener(LiveFrameBuffer& frames, int color_width, bool with_infrared = false)
      : frames_(frames), color_width_(color_width), with_infrared_(with_infrared) {}
  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override;

  /// Before a device opened anew is started: it counts its time from somewhere else.
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
  cv::Mat infrared_;  ///< of the depth image that comes next, on the same thread
  DeviceClock clock_{kNsPerTick};
  std::atomic<size_t> faulty_ = 0;
};

}  // namespace kinloop
