#pragma once
// The Kinect 2's frame source. Requires libfreenect2's headers; internal to the Kinect 2 driver and its
// tests.

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include <libfreenect2/frame_listener.hpp>

#include "drivers/kinect2/kinect2_device.hpp"
#include "drivers/live/device_clock.hpp"
#include "drivers/live/live_frames.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

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

/// A Kinect 2 opened by `open`, which tests replace by their own device.
class Kinect2Source : public FrameSource {
 public:
  /// `open` is called at the start and after the camera was unplugged; it throws InputError if there is none.
  Kinect2Source(std::function<Kinect2Handle()> open, const KinectOptions& options,
                const std::optional<RgbdCamera>& calibration,
                Kinect2Frames frames = Kinect2Frames::kRegistered);
  ~Kinect2Source() override;
  Kinect2Source(const Kinect2Source&) = delete;
  Kinect2Source& operator=(const Kinect2Source&) = delete;

  std::optional<Frame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override;

 private:
  void reopen();

  std::function<Kinect2Handle()> open_;
  KinectOptions options_;
  SourceInfo info_;
  RgbdCamera camera_;                              ///< of the frames
  double shift_m_ = 0;                             ///< added to measured depth
  std::optional<DepthRegistration> registration_;  ///< empty if depth is kept separate
  cv::Mat color_remap_;  ///< position of each output pixel in the received colour image; empty: identity
  LiveFrameBuffer frames_;
  Kinect2Listener listener_;
  Kinect2Handle handle_;  // declared last: it uses the listener
};

}  // namespace kinloop
