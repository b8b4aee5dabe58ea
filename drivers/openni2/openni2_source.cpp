#include "drivers/openni2/openni2_source.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_OPENNI2

#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <openni2/OpenNI.h>

#include "drivers/live/device_clock.hpp"
#include "drivers/live/live_source.hpp"
#include "drivers/openni2/openni_image.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

/// libOpenNI2 with its drivers.
std::shared_ptr<void> load_library() {
  if (openni::OpenNI::initialize() != openni::STATUS_OK)
    throw InputError("openni2: no driver is found; install libopenni2-0");
  return {nullptr, [](void*) { openni::OpenNI::shutdown(); }};
}

/// 640 x 480 at 30 Hz, or the mode that the device is in if it does not have that.
void choose_mode(openni::VideoStream& stream, openni::PixelFormat pixels) {
  openni::VideoMode mode;
  mode.setResolution(640, 480), mode.setFps(30), mode.setPixelFormat(pixels);
  stream.setVideoMode(mode);
}

cv::Size size_of(const openni::VideoStream& stream) {
  const auto mode = stream.getVideoMode();
  return {mode.getResolutionX(), mode.getResolutionY()};
}

/// Passes the images of one stream on, in the library's thread.
class OpenNi2Listener : public openni::VideoStream::NewFrameListener {
 public:
  OpenNi2Listener(LiveFrameBuffer& to, DeviceClock& clock, bool depth)
      : frames_(to), clock_(clock), depth_(depth) {}

  void onNewFrame(openni::VideoStream& stream) override {
    openni::VideoStream* streams[] = {&stream};
    int index = 0;
    openni::VideoFrameRef frame;
    // Two calls may come for one frame: readFrame would wait for the next, or return none.
    if (openni::OpenNI::waitForAnyStream(streams, 1, &index, 0) != openni::STATUS_OK ||
        stream.readFrame(&frame) != openni::STATUS_OK || !frame.isValid())
      return;
    OpenNiImage image;
    image.width = frame.getWidth(), image.height = frame.getHeight();
    image.stride = static_cast<size_t>(frame.getStrideInBytes());
    image.pixels = static_cast<OpenNiPixels>(frame.getVideoMode().getPixelFormat());
    image.mirrored = stream.getMirroringEnabled();
    image.data = {static_cast<const uint8_t*>(frame.getData()), static_cast<size_t>(frame.getDataSize())};
    const int64_t stamp_ns = clock_.stamp_ns(static_cast<uint32_t>(frame.getTimestamp()));
    try {
      if (depth_) return frames_.add_depth(stamp_ns, depth_from(image));
      frames_.add_color(stamp_ns, color_from(image));
    } catch (const InputError& error) {
      if (!std::exchange(warned_, true)) log::warn("openni2: an image is left out: {}", error.what());
    }
  }

 private:
  LiveFrameBuffer& frames_;
  DeviceClock& clock_;
  bool depth_, warned_ = false;
};

/// The device and its streams.
class OpenNi2Device {
 public:
  OpenNi2Device(const std::string& uri, LiveFrameBuffer& frames)
      : on_color_(frames, clock_, false), on_depth_(frames, clock_, true) {
    if (device_.open(uri.empty() ? openni::ANY_DEVICE : uri.c_str()) != openni::STATUS_OK)
      throw InputError("openni2: no camera found" + (uri.empty() ? "" : " at " + uri) +
                       "; connect it, and check its driver and the access rights (udev rules)");
    open_stream(color_, openni::SENSOR_COLOR, openni::PIXEL_FORMAT_RGB888);
    open_stream(depth_, openni::SENSOR_DEPTH, openni::PIXEL_FORMAT_DEPTH_1_MM);
    constexpr auto kRegistered = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (!device_.isImageRegistrationModeSupported(kRegistered) ||
        device_.setImageRegistrationMode(kRegistered) != openni::STATUS_OK)
      log::warn("openni2: the device does not register depth to colour; calibrate it (kinloop calibrate)");
    device_.setDepthColorSyncEnabled(true);  // a device without it is paired by time
  }

  void start() {
    if (color_.addNewFrameListener(&on_color_) != openni::STATUS_OK ||
        depth_.addNewFrameListener(&on_depth_) != openni::STATUS_OK || color_.start() != openni::STATUS_OK ||
        depth_.start() != openni::STATUS_OK)
      throw InputError("openni2: the streams do not start; unplug the camera and plug it in again");
  }

  /// The camera of colour, to which depth is registered. Only its size if its lens is `calibrated`.
  [[nodiscard]] RgbdCamera camera(bool calibrated) const {
    const cv::Size size = size_of(color_), depth_size = size_of(depth_);
    if (depth_size != size)
      throw InputError(fmt::format("openni2: depth of {} x {} pixels where colour has {} x {}",
                                   depth_size.width, depth_size.height, size.width, size.height));
    RgbdCamera camera;
    camera.color.width = size.width, camera.color.height = size.height;
    if (!calibrated)
      camera.color = camera_with_view("openni2", size, color_.getHorizontalFieldOfView(),
                                      color_.getVerticalFieldOfView());
    camera.fps = color_.getVideoMode().getFps();
    return camera;
  }

 private:
  void open_stream(openni::VideoStream& stream, openni::SensorType type, openni::PixelFormat pixels) {
    if (stream.create(device_, type) != openni::STATUS_OK)
      throw InputError("openni2: the camera does not have both colour and depth; use another");
    choose_mode(stream, pixels);
    stream.setMirroringEnabled(false);  // where it fails, the images are unmirrored
  }

  DeviceClock clock_{1e3};  ///< counts microseconds
  OpenNi2Listener on_color_, on_depth_;
  // A stream that is destroyed waits for the thread that calls its listener.
  std::shared_ptr<void> library_ = load_library();
  openni::Device device_;
  openni::VideoStream color_, depth_;
};

}  // namespace

bool openni2_available() {
  return true;
}

std::unique_ptr<FrameSource> open_openni2(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration) {
  const auto open = [uri = options.serial, calibrated = calibration.has_value()](LiveFrameBuffer& frames) {
    const auto device = std::make_shared<OpenNi2Device>(uri, frames);
    const RgbdCamera camera = device->camera(calibrated);
    device->start();
    return LiveDevice{camera, device};
  };
  auto source = open_live({"openni2", open, options.reconnect_s, options.stop}, calibration);
  if (!calibration)
    log::warn("openni2: no --camera: distortion is unknown; calibrate your camera (kinloop calibrate)");
  return source;
}

}  // namespace kinloop

#else

namespace kinloop {

bool openni2_available() {
  return false;
}

std::unique_ptr<FrameSource> open_openni2(const KinectOptions&, const std::optional<RgbdCamera>&) {
  throw UsageError("openni2: not supported by this build; install libopenni2-dev and rebuild");
}

}  // namespace kinloop

#endif
