#include "drivers/oak/oak_source.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_DEPTHAI

#include <chrono>
#include <exception>
#include <utility>
#include <vector>

#include <depthai/device/Device.hpp>
#include <depthai/pipeline/MessageQueue.hpp>
#include <depthai/pipeline/Pipeline.hpp>
#include <depthai/pipeline/datatype/ImgFrame.hpp>
#include <depthai/pipeline/node/Camera.hpp>
#include <depthai/pipeline/node/StereoDepth.hpp>
#include <fmt/format.h>

#include "drivers/live/device_clock.hpp"
#include "drivers/live/device_selection.hpp"
#include "drivers/live/live_source.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr float kRateHz = 30;
constexpr std::chrono::seconds kFirstFrame(5);  ///< the firmware has been loaded by then

std::shared_ptr<dai::Device> device_with(const std::string& id) {
  const std::vector<dai::DeviceInfo> devices = dai::Device::getAllAvailableDevices();
  std::vector<std::string> ids;
  for (const dai::DeviceInfo& device : devices) ids.push_back(device.getDeviceId());
  return std::make_shared<dai::Device>(devices[choose_device("oak", ids, id, "depthai's udev rules")]);
}

std::shared_ptr<dai::ImgFrame> first_of(dai::MessageQueue& queue) {
  bool timed_out = false;
  auto frame = queue.get<dai::ImgFrame>(kFirstFrame, timed_out);
  if (timed_out || !frame) throw InputError("oak: no frames; unplug the camera and plug it in again");
  return frame;
}

/// An open device, and its two cameras of depth.
class OakDevice {
 public:
  OakDevice(const std::string& id, std::pair<uint32_t, uint32_t> color_size) : pipeline_(device_with(id)) {
    if (pipeline_.getDefaultDevice()->getPlatform() != dai::Platform::RVC2)
      throw InputError("oak: only cameras with the processor RVC2 (OAK-D, Lite, Pro, S2, W) are supported");
    auto* const color = camera_at(dai::CameraBoardSocket::CAM_A)
                            ->requestOutput(color_size, dai::ImgFrame::Type::BGR888i,
                                            dai::ImgResizeMode::CROP, kRateHz, true);
    auto* const left = stereo_camera(dai::CameraBoardSocket::CAM_B);
    auto* const right = stereo_camera(dai::CameraBoardSocket::CAM_C);
    const auto stereo = pipeline_.create<dai::node::StereoDepth>()->build(*left, *right);
    stereo->setLeftRightCheck(true);
    stereo->setSubpixel(true);
    color->link(stereo->inputAlignTo);
    color_ = color->createOutputQueue();
    depth_ = stereo->depth.createOutputQueue();
  }
  ~OakDevice() {
    try {
      pipeline_.stop();
      pipeline_.wait();
    } catch (const std::exception& error) {  // unplugged
      log::debug("oak: {}", error.what());
    }
  }
  OakDevice(const OakDevice&) = delete;
  OakDevice& operator=(const OakDevice&) = delete;

  /// Passes the images on, in threads of the library. Returns the camera, which comes with the first image.
  RgbdCamera start(LiveFrameBuffer& to) {
    pipeline_.start();
    const auto color = first_of(*color_), depth = first_of(*depth_);
    if (color->getWidth() != depth->getWidth() || color->getHeight() != depth->getHeight())
      throw InputError(fmt::format("oak: depth of {} x {} pixels where colour has {} x {}", depth->getWidth(),
                                   depth->getHeight(), color->getWidth(), color->getHeight()));
    for (const auto& queue : {color_, depth_}) {
      queue->addCallback(
          [this, is_depth = queue == depth_, &to](const std::shared_ptr<dai::ADatatype>& message) {
            if (const auto image = std::dynamic_pointer_cast<dai::ImgFrame>(message))
              pass_on(*image, is_depth, to);
          });
    }
    return camera_of(*color);
  }

 private:
  std::shared_ptr<dai::node::Camera> camera_at(dai::CameraBoardSocket socket) {
    return pipeline_.create<dai::node::Camera>()->build(socket);
  }

  dai::Node::Output* stereo_camera(dai::CameraBoardSocket socket) {
    return camera_at(socket)->requestOutput({640, 400}, std::nullopt, dai::ImgResizeMode::CROP, kRateHz);
  }

  static RgbdCamera camera_of(dai::ImgFrame& color) {
    const auto K = color.getTransformation().getIntrinsicMatrix();
    RgbdCamera camera;
    camera.color.width = static_cast<int>(color.getWidth());
    camera.color.height = static_cast<int>(color.getHeight());
    camera.color.fx = K[0][0], camera.color.fy = K[1][1], camera.color.cx = K[0][2],
    camera.color.cy = K[1][2];
    camera.fps = kRateHz;
    camera.sensor.set_by_source(DepthSensorModel::kStereo);
    return camera;
  }

  void pass_on(dai::ImgFrame& image, bool is_depth, LiveFrameBuffer& to) {
    RosImage pixels;
    pixels.width = static_cast<int>(image.getWidth()), pixels.height = static_cast<int>(image.getHeight());
    pixels.step = image.getStride();
    pixels.encoding = is_depth ? "16UC1" : "bgr8";
    pixels.data = {image.getData().data(), image.getData().size()};
    const auto time = image.getTimestampDevice().time_since_epoch();
    const auto time_us = std::chrono::duration_cast<std::chrono::microseconds>(time).count();
    const int64_t stamp_ns = clock_.stamp_ns(static_cast<uint32_t>(time_us));
    try {
      if (is_depth) return to.add_depth(stamp_ns, depth_from(pixels));
      to.add_color(stamp_ns, color_from(pixels));
    } catch (const InputError& error) {
      log::warn("oak: an image is left out: {}", error.what());
    }
  }

  DeviceClock clock_{1e3};  ///< counts microseconds
  dai::Pipeline pipeline_;
  std::shared_ptr<dai::MessageQueue> color_, depth_;
};

}  // namespace

bool oak_available() {
  return true;
}

std::unique_ptr<FrameSource> open_oak(const KinectOptions& options,
                                      const std::optional<RgbdCamera>& calibration) {
  constexpr uint32_t kRows = 9, kColumns = 16;  // of the images of all OAK cameras
  const auto width = static_cast<uint32_t>(stream_widths(options.width, calibration).color);
  const auto open = [id = options.serial, width](LiveFrameBuffer& to) {
    try {
      const auto device = std::make_shared<OakDevice>(id, std::make_pair(width, width * kRows / kColumns));
      return LiveDevice{device->start(to), device};
    } catch (const InputError&) {
      throw;
    } catch (const std::exception& error) {
      throw InputError(fmt::format("oak: {}; unplug the camera and plug it in again", error.what()));
    }
  };
  return open_live({"oak", open, options.reconnect_s, options.stop}, calibration);
}

}  // namespace kinloop

#else

namespace kinloop {

bool oak_available() {
  return false;
}

std::unique_ptr<FrameSource> open_oak(const KinectOptions&, const std::optional<RgbdCamera>&) {
  throw UsageError("oak: not supported by this build; install depthai 3 and rebuild (docs/cameras.md)");
}

}  // namespace kinloop

#endif
