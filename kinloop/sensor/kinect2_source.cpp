#include "kinloop/sensor/kinect2_source.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"

#ifdef KINLOOP_WITH_FREENECT2

#include <chrono>
#include <thread>

#include <libfreenect2/config.h>
#include <libfreenect2/logger.h>
#include <libfreenect2/packet_pipeline.h>
#include <libfreenect2/registration.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/base/log.hpp"
#include "kinloop/base/time.hpp"
#include "kinloop/sensor/kinect2_stream.hpp"

namespace kinloop {
namespace {

constexpr int kColorWidth = 1920, kColorHeight = 1080, kDepthWidth = 512, kDepthHeight = 424;
constexpr double kMillimetresPerMetre = 1000;
constexpr std::chrono::milliseconds kPatience(1000);  ///< thirty frames: the camera is gone

/// The camera of the mirrored image.
PinholeCamera mirrored(PinholeCamera camera) {
  camera.cx = camera.width - 1 - camera.cx;
  camera.p2 = -camera.p2;
  return camera;
}

PinholeCamera color_lens(const libfreenect2::Freenect2Device::ColorCameraParams& p) {
  PinholeCamera camera;
  camera.width = kColorWidth, camera.height = kColorHeight;
  camera.fx = p.fx, camera.fy = p.fy, camera.cx = p.cx, camera.cy = p.cy;
  return camera;
}

PinholeCamera depth_lens(const libfreenect2::Freenect2Device::IrCameraParams& p) {
  PinholeCamera camera;
  camera.width = kDepthWidth, camera.height = kDepthHeight;
  camera.fx = p.fx, camera.fy = p.fy, camera.cx = p.cx, camera.cy = p.cy;
  camera.k1 = p.k1, camera.k2 = p.k2, camera.p1 = p.p1, camera.p2 = p.p2, camera.k3 = p.k3;
  return camera;
}

/// Width in which colour is kept: as asked for, or twice the depth camera's to be turned into its view.
int received_width(const KinectOptions& options) {
  constexpr int kHalf = 960;
  if (options.width != kColorWidth && options.width != kHalf && options.width != kDepthWidth) {
    throw UsageError(fmt::format("kinect.width={}: one of 1920, 960 and 512", options.width));
  }
  return options.width == kDepthWidth ? kHalf : options.width;
}

/// A camera without distortion that sees as much as the depth camera, and from where the colour camera
/// stands.
PinholeCamera view_of_depth_camera(const PinholeCamera& depth) {
  PinholeCamera view = depth;
  view.k1 = view.k2 = view.p1 = view.p2 = view.k3 = 0;
  return view;
}

/// For each pixel of `to` the pixel of `from` in the same direction.
cv::Mat map_between(const PinholeCamera& to, const PinholeCamera& from) {
  cv::Mat map(to.height, to.width, CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const Eigen::Vector3d ray = to.unproject(to.undistort(Eigen::Vector2d(x, y)), 1);
      const Eigen::Vector2f pixel = from.distort(from.project(ray)).cast<float>();
      map.at<cv::Vec2f>(y, x) = {pixel.x(), pixel.y()};
    }
  }
  return map;
}

libfreenect2::PacketPipeline* make_pipeline(const std::string& name) {
#ifdef LIBFREENECT2_WITH_OPENGL_SUPPORT
  if (name == "opengl") return new libfreenect2::OpenGLPacketPipeline;
#endif
#ifdef LIBFREENECT2_WITH_OPENCL_SUPPORT
  if (name == "opencl") return new libfreenect2::OpenCLPacketPipeline;
#endif
#ifdef LIBFREENECT2_WITH_CUDA_SUPPORT
  if (name == "cuda") return new libfreenect2::CudaPacketPipeline;
#endif
  if (name == "cpu") return new libfreenect2::CpuPacketPipeline;
  throw UsageError(fmt::format("kinect.pipeline={}: not in this libfreenect2; try auto or cpu", name));
}

Kinect2Handle open_device(const KinectOptions& options) {
  // libfreenect2 writes to the terminal of its own accord; what matters is said here.
  libfreenect2::setGlobalLogger(libfreenect2::createConsoleLogger(libfreenect2::Logger::Error));
  const auto context = std::make_shared<libfreenect2::Freenect2>();
  const int count = context->enumerateDevices();
  if (count == 0) {
    throw InputError(
        "kinect2: no Kinect 2 found; plug it into a USB 3 port and into the mains, and see that you may "
        "use it (libfreenect2's udev rules)");
  }
  std::string known;
  for (int i = 0; i < count; ++i) known += (i == 0 ? "" : ", ") + context->getDeviceSerialNumber(i);
  const std::string serial = options.serial.empty() ? context->getDeviceSerialNumber(0) : options.serial;
  if (known.find(serial) == std::string::npos) {
    throw InputError(
        fmt::format("kinect2: no Kinect 2 with the serial number {}; there are: {}", serial, known));
  }
  auto* device = options.pipeline == "auto" ? context->openDevice(serial)
                                            : context->openDevice(serial, make_pipeline(options.pipeline));
  if (device == nullptr) {
    throw InputError(fmt::format("kinect2: {} cannot be opened; another program may be using it", serial));
  }
  return {context, device};
}

}  // namespace

bool Kinect2Listener::onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) {
  if (frame->status != 0) {
    ++faulty_;
    return false;
  }
  const int64_t stamp = stamp_ns(frame->timestamp);
  const cv::Size size(static_cast<int>(frame->width), static_cast<int>(frame->height));
  if (type == libfreenect2::Frame::Color) {
    const bool rgb = frame->format == libfreenect2::Frame::RGBX;
    cv::Mat color, mirror(size, CV_8UC4, frame->data);
    cv::cvtColor(mirror, color, rgb ? cv::COLOR_RGBA2BGR : cv::COLOR_BGRA2BGR);
    if (color_width_ < color.cols) {
      const int height =
          static_cast<int>(std::lround(static_cast<double>(color.rows) * color_width_ / color.cols));
      cv::resize(color, color, {color_width_, height}, 0, 0, cv::INTER_AREA);
    }
    cv::flip(color, color, 1);
    frames_.add_color(stamp, color);
  } else if (type == libfreenect2::Frame::Depth) {
    cv::Mat depth_m;
    cv::Mat(size, CV_32FC1, frame->data).convertTo(depth_m, CV_32FC1, 1 / kMillimetresPerMetre);
    depth_m.setTo(0, ~(depth_m > 0));  // not a number, too
    cv::flip(depth_m, depth_m, 1);
    frames_.add_depth(stamp, depth_m);
  }
  return false;  // libfreenect2 keeps its frame
}

int64_t Kinect2Listener::stamp_ns(uint32_t ticks) {
  constexpr int64_t kNsPerTick = 125'000;
  const std::lock_guard lock(clock_mutex_);
  if (!last_ticks_) {
    time_ns_ = std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  } else {
    // The counter wraps around; colour and depth come in either order.
    time_ns_ += static_cast<int32_t>(ticks - *last_ticks_) * kNsPerTick;
  }
  last_ticks_ = ticks;
  return time_ns_;
}

RgbdCamera factory_camera(const libfreenect2::Freenect2Device::ColorCameraParams& color,
                          const libfreenect2::Freenect2Device::IrCameraParams& infrared) {
  const libfreenect2::Registration mapping(infrared, color);
  const PinholeCamera depth = depth_lens(infrared);
  // Where libfreenect2 sees points of the depth camera in the colour image, over the image and near and far.
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  constexpr int kStep = 32;
  for (int y = kStep / 2; y < kDepthHeight; y += kStep) {
    for (int x = kStep / 2; x < kDepthWidth; x += kStep) {
      for (const double z : {0.7, 1.5, 4.0}) {
        float u = 0, v = 0;
        // The mapping takes pixels with their distortion.
        mapping.apply(x, y, static_cast<float>(z * kMillimetresPerMetre), u, v);
        const bool inside = u >= 0 && v >= 0 && u < kColorWidth && v < kColorHeight;
        if (!inside) continue;
        const Eigen::Vector3d p = depth.unproject(depth.undistort(Eigen::Vector2d(x, y)), z);
        points.emplace_back(p.x(), p.y(), p.z());
        pixels.emplace_back(static_cast<double>(u), static_cast<double>(v));
      }
    }
  }
  constexpr size_t kFewest = 20;
  if (points.size() < kFewest) {
    throw InputError("kinect2: the device's factory calibration cannot be read; give --camera FILE");
  }
  const PinholeCamera lens = color_lens(color);
  const cv::Matx33d K(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  cv::solvePnP(points, pixels, K, cv::noArray(), rotation, translation);
  // Out of the mirror: x changes its sign, and with it the rotations about y and z.
  RgbdCamera camera;
  camera.color = mirrored(lens);
  camera.depth = mirrored(depth);
  camera.T_color_depth = {exp_so3({rotation[0], -rotation[1], -rotation[2]}),
                          {-translation[0], translation[1], translation[2]}};
  return camera;
}

Kinect2Source::Kinect2Source(std::function<Kinect2Handle()> open, const KinectOptions& options,
                             const std::optional<RgbdCamera>& calibration)
    : open_(std::move(open)),
      options_(options),
      listener_(frames_, received_width(options)),
      handle_(open_()) {
  info_.name = "kinect2";
  info_.live = true;
  RgbdCamera rig = calibration ? *calibration
                               : factory_camera(handle_.device->getColorCameraParams(),
                                                handle_.device->getIrCameraParams());
  if (!rig.depth) {
    throw InputError(
        "kinect2: the --camera file has no 'depth' camera; make one with kinloop calibrate extrinsics, or "
        "leave --camera out for the factory's calibration");
  }
  rig.color = resized(rig.color, received_width(options));
  if (options.width == kDepthWidth) {
    const PinholeCamera view = view_of_depth_camera(*rig.depth);
    to_view_ = map_between(view, rig.color);
    rig.color = view;
  }
  shift_m_ = rig.depth_shift_m;
  registration_.emplace(rig);
  camera_.color = rig.color;
  start();
}

Kinect2Source::~Kinect2Source() {
  stop();
}

void Kinect2Source::start() {
  libfreenect2::Freenect2Device::Config config;
  config.MinDepth = static_cast<float>(options_.min_depth_m);
  config.MaxDepth = static_cast<float>(options_.max_depth_m);
  handle_.device->setConfiguration(config);
  handle_.device->setColorFrameListener(&listener_);
  handle_.device->setIrAndDepthFrameListener(&listener_);
  if (!handle_.device->start())
    throw InputError("kinect2: the device does not start; unplug it and plug it in again");
}

void Kinect2Source::stop() {
  if (handle_.device == nullptr) return;
  handle_.device->stop();
  handle_.device->close();
  handle_ = {};
}

bool Kinect2Source::reconnect() {
  log::warn("kinect2: no frames for {} s: unplugged? Waiting up to {} s for it", kPatience.count() / 1000,
            options_.reconnect_s);
  stop();
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(options_.reconnect_s);
  while (std::chrono::steady_clock::now() < until) {
    try {
      handle_ = open_();
      start();
      log::warn("kinect2: it is back");
      return true;
    } catch (const InputError&) {
      handle_ = {};
      std::this_thread::sleep_for(kPatience / 2);
    }
  }
  return false;
}

std::optional<RgbdFrame> Kinect2Source::next() {
  std::optional<RgbdFrame> frame = frames_.wait(kPatience);
  while (!frame) {
    if (!reconnect()) {
      log::error("kinect2: the camera is gone; finishing with the frames there are");
      return std::nullopt;
    }
    frame = frames_.wait(kPatience);
  }
  if (shift_m_ != 0) cv::add(frame->depth_m, shift_m_, frame->depth_m, frame->depth_m > 0);
  frame->depth_m = (*registration_)(frame->depth_m);
  if (!to_view_.empty()) cv::remap(frame->color, frame->color, to_view_, cv::noArray(), cv::INTER_LINEAR);
  return frame;
}

std::vector<SkippedFrame> Kinect2Source::skipped() const {
  auto skipped = skipped_of(frames_.counts());
  skipped.insert(skipped.end(), listener_.faulty(), {"image", "marked as faulty by the driver"});
  return skipped;
}

bool kinect2_available() {
  return true;
}

std::unique_ptr<FrameSource> open_kinect2(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration) {
  return std::make_unique<Kinect2Source>([options] { return open_device(options); }, options, calibration);
}

}  // namespace kinloop

#else

namespace kinloop {

bool kinect2_available() {
  return false;
}

std::unique_ptr<FrameSource> open_kinect2(const KinectOptions&, const std::optional<RgbdCamera>&) {
  throw UsageError(
      "kinect2: this build knows no Kinect 2; install libfreenect2 and build again (docs/cameras.md)");
}

}  // namespace kinloop

#endif
