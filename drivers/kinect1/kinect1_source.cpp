#include "drivers/kinect1/kinect1_source.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_FREENECT

#include <string>
#include <thread>

#include <libfreenect.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/live/device_clock.hpp"
#include "drivers/live/live_source.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr double kMillimetresPerMetre = 1000;
constexpr double kNsPerTick = 1e9 / 60e6;  ///< the device counts at 60 MHz

/// Of colour, to which the device registers depth. Published for the Kinect 1 by several groups; an
/// individual camera may differ by some per cent.
RgbdCamera typical_camera() {
  RgbdCamera camera;
  camera.color.width = kWidth, camera.color.height = kHeight;
  camera.color.fx = camera.color.fy = 525, camera.color.cx = 319.5, camera.color.cy = 239.5;
  camera.sensor.set_by_source(DepthSensorModel::kKinect1);
  return camera;
}

/// Returns the serial number of the camera that libfreenect opens as the first; empty if it has none.
std::string serial_of_first(freenect_context* context) {
  freenect_device_attributes* devices = nullptr;
  if (freenect_list_device_attributes(context, &devices) < 1) return {};
  std::string serial = devices->camera_serial != nullptr ? devices->camera_serial : "";
  freenect_free_device_attributes(devices);
  return serial;
}

/// libfreenect's context and device, closed in the right order.
class Device {
 public:
  explicit Device(LiveFrameBuffer& frames) : frames_(frames) {
    if (freenect_init(&context_, nullptr) < 0) throw InputError("kinect1: cannot initialise libusb");
    freenect_set_log_level(context_, FREENECT_LOG_FATAL);
    freenect_select_subdevices(context_, FREENECT_DEVICE_CAMERA);
    try {
      open();
    } catch (...) {
      close();
      throw;
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~Device() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    close();
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] const std::string& serial() const { return serial_; }

 private:
  void open() {
    if (freenect_num_devices(context_) < 1) {
      throw InputError(
          "kinect1: no Kinect 1 found; connect USB and power, and check the access rights "
          "(libfreenect's udev rules)");
    }
    if (freenect_open_device(context_, &device_, 0) < 0) {
      throw InputError(
          "kinect1: the camera cannot be opened; another program or the kernel's gspca_kinect may be "
          "using it");
    }
    serial_ = serial_of_first(context_);
    freenect_set_user(device_, this);
    freenect_set_video_callback(device_, [](freenect_device* device, void* data, uint32_t ticks) {
      static_cast<Device*>(freenect_get_user(device))->on_color(data, ticks);
    });
    freenect_set_depth_callback(device_, [](freenect_device* device, void* data, uint32_t ticks) {
      static_cast<Device*>(freenect_get_user(device))->on_depth(data, ticks);
    });
    freenect_set_video_mode(device_,
                            freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_VIDEO_RGB));
    freenect_set_depth_mode(device_,
                            freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_REGISTERED));
    if (freenect_start_video(device_) < 0 || freenect_start_depth(device_) < 0) {
      throw InputError("kinect1: the streams do not start; unplug the camera and plug it in again");
    }
  }

  void close() {
    if (device_ != nullptr) {
      freenect_stop_depth(device_);
      freenect_stop_video(device_);
      freenect_close_device(device_);
    }
    if (context_ != nullptr) freenect_shutdown(context_);
    device_ = nullptr;
    context_ = nullptr;
  }

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      timeval wait{0, 100'000};
      if (freenect_process_events_timeout(context_, &wait) < 0) return;
    }
  }

  void on_color(void* data, uint32_t ticks) {
    cv::Mat color;
    cv::cvtColor(cv::Mat(kHeight, kWidth, CV_8UC3, data), color, cv::COLOR_RGB2BGR);
    frames_.add_color(clock_.stamp_ns(ticks), color);
  }

  void on_depth(void* data, uint32_t ticks) {
    cv::Mat depth_m;
    cv::Mat(kHeight, kWidth, CV_16UC1, data).convertTo(depth_m, CV_32FC1, 1 / kMillimetresPerMetre);
    frames_.add_depth(clock_.stamp_ns(ticks), depth_m);
  }

  LiveFrameBuffer& frames_;
  freenect_context* context_ = nullptr;
  freenect_device* device_ = nullptr;
  std::string serial_;
  DeviceClock clock_{kNsPerTick};
  std::jthread thread_;
};

}  // namespace

bool kinect1_available() {
  return true;
}

std::unique_ptr<FrameSource> open_kinect1(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration) {
  const auto open = [](LiveFrameBuffer& frames) {
    const auto device = std::make_shared<Device>(frames);
    return LiveDevice{typical_camera(), device, device->serial()};
  };
  auto source = open_live({"kinect1", open, options.reconnect_s, options.stop}, calibration);
  if (!calibration)
    log::warn("kinect1: no --camera: using typical intrinsics; calibrate your camera (kinloop calibrate)");
  return source;
}

}  // namespace kinloop

#else

namespace kinloop {

bool kinect1_available() {
  return false;
}

std::unique_ptr<FrameSource> open_kinect1(const KinectOptions&, const std::optional<RgbdCamera>&) {
  throw UsageError("kinect1: not supported by this build; install libfreenect-dev and rebuild");
}

}  // namespace kinloop

#endif
