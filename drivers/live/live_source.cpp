#include "drivers/live/live_source.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/live/reconnection.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

constexpr std::chrono::milliseconds kSilenceOfUnplugged(2000);  ///< without frames the camera is gone

void require_size(const std::string& name, const char* what, const PinholeCamera& device,
                  const PinholeCamera& calibration) {
  if (device.width == calibration.width && device.height == calibration.height) return;
  throw InputError(fmt::format("{}: {} of {} x {} pixels where the --camera file has {} x {}", name, what,
                               device.width, device.height, calibration.width, calibration.height));
}

/// The calibration, with the sensor that the device knows.
RgbdCamera checked(const std::string& name, RgbdCamera calibration, const RgbdCamera& device) {
  require_size(name, "colour", device.color, calibration.color);
  if (device.depth && !calibration.depth)
    throw InputError(fmt::format(
        "{}: the --camera file has no 'depth' camera; add it and T_color_depth, or omit --camera to use the "
        "factory calibration",
        name));
  if (!device.depth) calibration.depth.reset();  // registered by the device
  if (device.depth) require_size(name, "depth", *device.depth, *calibration.depth);
  if (device.sensor.origin != SensorOrigin::kAssumed) calibration.sensor.set_by_source(device.sensor.model);
  return calibration;
}

class LiveSource : public FrameSource {
 public:
  LiveSource(const LiveCamera& live, const std::optional<RgbdCamera>& calibration)
      : live_(live), device_(live.open(frames_)) {
    info_.name = live.name, info_.live = true, info_.serial = device_.serial;
    camera_ = calibration ? checked(live.name, *calibration, device_.camera) : device_.camera;
    prepare_depth_.emplace(camera_);
  }

  std::optional<Frame> next() override {
    auto frame = next_or_reconnect(
        frames_, {live_.name, kSilenceOfUnplugged, live_.reconnect_s, [this] { device_.streams.reset(); },
                  [this] { device_ = live_.open(frames_); }, live_.stop});
    if (frame) frame->depth_m = (*prepare_depth_)(frame->depth_m);
    return frame;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return to_skipped_frames(frames_.counts()); }

 private:
  LiveCamera live_;
  SourceInfo info_;
  RgbdCamera camera_;
  std::optional<DepthPreparation> prepare_depth_;
  LiveFrameBuffer frames_;
  LiveDevice device_;  // declared last: it fills the frames
};

}  // namespace

std::unique_ptr<FrameSource> open_live(const LiveCamera& live, const std::optional<RgbdCamera>& calibration) {
  return std::make_unique<LiveSource>(live, calibration);
}

}  // namespace kinloop
