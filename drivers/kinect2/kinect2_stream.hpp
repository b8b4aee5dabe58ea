#pragma once
// The Kinect 2's frame source. Requires libfreenect2's headers; internal to the Kinect 2 driver and its
// tests.

#include <functional>
#include <optional>
#include <vector>

#include "drivers/kinect2/kinect2_device.hpp"
#include "drivers/kinect2/kinect2_listener.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

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
