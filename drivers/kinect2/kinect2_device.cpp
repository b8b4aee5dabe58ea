#ifdef KINLOOP_WITH_FREENECT2

#include "drivers/kinect2/kinect2_device.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <libfreenect2/config.h>
#include <libfreenect2/logger.h>
#include <libfreenect2/packet_pipeline.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

libfreenect2::PacketPipeline* make_packet_pipeline(KinectPipeline pipeline) {
#ifdef LIBFREENECT2_WITH_OPENGL_SUPPORT
  if (pipeline == KinectPipeline::kOpenGl) return new libfreenect2::OpenGLPacketPipeline;
#endif
#ifdef LIBFREENECT2_WITH_OPENCL_SUPPORT
  if (pipeline == KinectPipeline::kOpenCl) return new libfreenect2::OpenCLPacketPipeline;
#endif
#ifdef LIBFREENECT2_WITH_CUDA_SUPPORT
  if (pipeline == KinectPipeline::kCuda) return new libfreenect2::CudaPacketPipeline;
#endif
  if (pipeline == KinectPipeline::kCpu) return new libfreenect2::CpuPacketPipeline;
  throw UsageError(
      fmt::format("kinect.pipeline={}: not in this libfreenect2; try auto or cpu", name_of(pipeline)));
}

}  // namespace

Kinect2Handle open_kinect2_device(const KinectOptions& options, const MakePipeline& make_pipeline) {
  // Silences libfreenect2 except for errors; kinloop logs what matters.
  libfreenect2::setGlobalLogger(libfreenect2::createConsoleLogger(libfreenect2::Logger::Error));
  const auto context = std::make_shared<libfreenect2::Freenect2>();
  const int count = context->enumerateDevices();
  if (count == 0) {
    throw InputError(
        "kinect2: no Kinect 2 found; connect USB 3 and power, and check the access rights "
        "(libfreenect2's udev rules)");
  }
  std::vector<std::string> known;
  for (int i = 0; i < count; ++i) known.push_back(context->getDeviceSerialNumber(i));
  const std::string serial = options.serial.empty() ? known.front() : options.serial;
  if (std::find(known.begin(), known.end(), serial) == known.end()) {
    throw InputError(fmt::format("kinect2: no Kinect 2 with the serial number {}; there are: {}", serial,
                                 fmt::join(known, ", ")));
  }
  libfreenect2::Freenect2Device* device = nullptr;
  if (make_pipeline) {
    device = context->openDevice(serial, make_pipeline());
  } else if (options.pipeline == KinectPipeline::kAuto) {
    device = context->openDevice(serial);
  } else {
    device = context->openDevice(serial, make_packet_pipeline(options.pipeline));
  }
  if (device == nullptr) {
    throw InputError(fmt::format("kinect2: {} cannot be opened; another program may be using it", serial));
  }
  return {context, device};
}

void start_kinect2(const Kinect2Handle& handle, libfreenect2::FrameListener& listener,
                   const KinectOptions& options) {
  libfreenect2::Freenect2Device::Config config;
  config.MinDepth = static_cast<float>(options.min_depth_m);
  config.MaxDepth = static_cast<float>(options.max_depth_m);
  handle.device->setConfiguration(config);
  handle.device->setColorFrameListener(&listener);
  handle.device->setIrAndDepthFrameListener(&listener);
  if (!handle.device->start())
    throw InputError("kinect2: the device does not start; unplug it and plug it in again");
}

void close_kinect2(Kinect2Handle& handle) {
  if (handle.device == nullptr) return;
  handle.device->stop();
  handle.device->close();
  handle = {};
}

}  // namespace kinloop

#endif
