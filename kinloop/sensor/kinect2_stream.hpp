#pragma once
// What the Kinect 2's source is made of; for it and its tests only, as it needs libfreenect2's headers.

#include <functional>
#include <memory>

#include <libfreenect2/frame_listener.hpp>
#include <libfreenect2/libfreenect2.hpp>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/kinect_options.hpp"
#include "kinloop/sensor/live_frames.hpp"
#include "kinloop/sensor/registration.hpp"

namespace kinloop {

/// Takes libfreenect2's frames, which are mirrored, and hands on copies of them that are not. Colour is made
/// smaller to `color_width`; frames that the driver marks as faulty are counted.
class Kinect2Listener : public libfreenect2::FrameListener {
 public:
  Kinect2Listener(LiveFrames& frames, int color_width) : frames_(frames), color_width_(color_width) {}
  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override;
  [[nodiscard]] size_t faulty() const { return faulty_; }

 private:
  int64_t stamp_ns(uint32_t ticks);

  LiveFrames& frames_;
  int color_width_;
  std::mutex clock_mutex_;
  std::optional<uint32_t> last_ticks_;
  int64_t time_ns_ = 0;
  std::atomic<size_t> faulty_ = 0;
};

/// The cameras as the factory measured them, for images that are not mirrored. libfreenect2's polynomial from
/// depth to colour becomes the rigid motion that fits it best.
RgbdCamera factory_camera(const libfreenect2::Freenect2Device::ColorCameraParams& color,
                          const libfreenect2::Freenect2Device::IrCameraParams& infrared);

/// An open device and what must live as long as it; the context deletes the device.
struct Kinect2Handle {
  std::shared_ptr<void> context;
  libfreenect2::Freenect2Device* device = nullptr;
};

class Kinect2Source : public FrameSource {
 public:
  /// `open` is called to begin and after the camera was unplugged; it throws InputError when there is none.
  Kinect2Source(std::function<Kinect2Handle()> open, const KinectOptions& options,
                const std::optional<RgbdCamera>& calibration);
  ~Kinect2Source() override;
  Kinect2Source(const Kinect2Source&) = delete;
  Kinect2Source& operator=(const Kinect2Source&) = delete;

  std::optional<RgbdFrame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] std::vector<SkippedFrame> skipped() const override;

 private:
  void start();
  void stop();
  bool reconnect();

  std::function<Kinect2Handle()> open_;
  KinectOptions options_;
  SourceInfo info_;
  RgbdCamera camera_;   ///< of the frames: depth is registered
  double shift_m_ = 0;  ///< of the measured depth
  std::optional<DepthRegistration> registration_;
  cv::Mat to_view_;  ///< where each pixel of the frames lies in the received colour image; empty: itself
  LiveFrames frames_;
  Kinect2Listener listener_;
  Kinect2Handle handle_;  // last: it uses the listener
};

}  // namespace kinloop
