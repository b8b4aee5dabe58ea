#include "drivers/orbbec/orbbec_source.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_ORBBEC

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <libobsensor/ObSensor.hpp>

#include "drivers/images/encoded_image.hpp"
#include "drivers/live/device_clock.hpp"
#include "drivers/live/device_selection.hpp"
#include "drivers/live/live_source.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "drivers/ros/realsense_bag.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

/// A format of the SDK and its name in ROS.
struct OrbbecFormat {
  OBFormat format;
  const char* encoding;
};
// The first is the best.
constexpr OrbbecFormat kColorFormats[] = {{OB_FORMAT_MJPG, "jpeg"},
                                          {OB_FORMAT_BGR, "bgr8"},
                                          {OB_FORMAT_RGB, "rgb8"},
                                          {OB_FORMAT_YUYV, "yuv422_yuy2"}};
constexpr OrbbecFormat kDepthFormats[] = {{OB_FORMAT_Y16, "16UC1"}};

std::ptrdiff_t rank_of(OBFormat format, std::span<const OrbbecFormat> formats) {
  return std::ranges::find(formats, format, &OrbbecFormat::format) - formats.begin();
}

std::shared_ptr<ob::Device> device_with(const ob::Context& context, const std::string& serial) {
  const auto devices = context.queryDeviceList();
  std::vector<std::string> serials;
  for (uint32_t i = 0; i < devices->getCount(); ++i) serials.emplace_back(devices->getSerialNumber(i));
  return devices->getDevice(
      static_cast<uint32_t>(choose_device("orbbec", serials, serial, "the SDK's udev rules")));
}

std::shared_ptr<ob::VideoStreamProfile> nearest_mode(const ob::Pipeline& pipeline, OBSensorType sensor,
                                                     std::span<const OrbbecFormat> formats, int width) {
  std::shared_ptr<ob::VideoStreamProfile> best;
  const auto distance = [&](const ob::VideoStreamProfile& mode) {
    const StreamMode size{static_cast<int>(mode.getWidth()), static_cast<int>(mode.getHeight()),
                          static_cast<int>(mode.getFps())};
    return std::make_pair(mode_distance(size, width), rank_of(mode.getFormat(), formats));
  };
  const auto modes = pipeline.getStreamProfileList(sensor);
  for (uint32_t i = 0; i < modes->getCount(); ++i) {
    const auto mode = modes->getProfile(i)->as<ob::VideoStreamProfile>();
    if (rank_of(mode->getFormat(), formats) == std::ssize(formats)) continue;
    if (!best || distance(*mode) < distance(*best)) best = mode;
  }
  if (!best) throw InputError("orbbec: the camera does not have both colour and depth; use another");
  return best;
}

PinholeCamera camera_of(const ob::VideoStreamProfile& mode) {
  const OBCameraIntrinsic lens = mode.getIntrinsic();
  const OBCameraDistortion d = mode.getDistortion();
  RosCameraInfo info;
  info.width = lens.width, info.height = lens.height;
  info.K = {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1};
  // The SDK distorts by the same formula in the models brown_conrady, inverse and modified.
  info.distortion_model = "plumb_bob", info.D = {d.k1, d.k2, d.p1, d.p2, d.k3};
  if (d.model == OB_DISTORTION_NONE) info.D.clear();
  if (d.model == OB_DISTORTION_BROWN_CONRADY_K6)
    info.distortion_model = "rational_polynomial", info.D.insert(info.D.end(), {d.k4, d.k5, d.k6});
  if (d.model == OB_DISTORTION_KANNALA_BRANDT4)
    info.distortion_model = "equidistant", info.D = {d.k1, d.k2, d.k3, d.k4};
  return camera_from(info, false);
}

DepthSensorModel orbbec_model(const std::string& name) {
  if (name.find("Femto") != std::string::npos) return DepthSensorModel::kAzureKinect;  // has its sensor
  if (name.find("Astra") != std::string::npos) return DepthSensorModel::kStructuredLight;
  return DepthSensorModel::kStereo;
}

/// An open device and its two streams.
class OrbbecDevice {
 public:
  OrbbecDevice(const std::string& serial, const StreamWidths& widths)
      : device_(device_with(context_, serial)),
        pipeline_(device_),
        color_(nearest_mode(pipeline_, OB_SENSOR_COLOR, kColorFormats, widths.color)),
        depth_(nearest_mode(pipeline_, OB_SENSOR_DEPTH, kDepthFormats, widths.depth)) {
    for (const auto mirror : {OB_PROP_COLOR_MIRROR_BOOL, OB_PROP_DEPTH_MIRROR_BOOL}) {
      if (device_->isPropertySupported(mirror, OB_PERMISSION_WRITE)) device_->setBoolProperty(mirror, false);
    }
  }

  ~OrbbecDevice() {
    try {
      pipeline_.stop();
    } catch (const ob::Error&) {  // not started, or unplugged
    }
  }
  OrbbecDevice(const OrbbecDevice&) = delete;
  OrbbecDevice& operator=(const OrbbecDevice&) = delete;

  [[nodiscard]] RgbdCamera camera() const {
    RgbdCamera camera;
    camera.color = camera_of(*color_), camera.depth = camera_of(*depth_);
    const OBExtrinsic pose = depth_->getExtrinsicTo(color_);  // rows of R first, mm
    const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix3f>(pose.rot).transpose().cast<double>();
    camera.T_color_depth = {Eigen::Quaterniond(R).normalized(),
                            1e-3 * Eigen::Map<const Eigen::Vector3f>(pose.trans).cast<double>()};
    camera.fps = color_->getFps();
    camera.sensor.set_by_source(orbbec_model(device_->getDeviceInfo()->getName()));
    return camera;
  }

  [[nodiscard]] std::string serial() const { return device_->getDeviceInfo()->getSerialNumber(); }

  /// Passes the images on, in threads of the library.
  void start(LiveFrameBuffer& to) {
    const auto config = std::make_shared<ob::Config>();
    for (std::shared_ptr<const ob::StreamProfile> mode : {color_, depth_}) config->enableStream(mode);
    config->setAlignMode(ALIGN_DISABLE);
    config->setFrameAggregateOutputMode(OB_FRAME_AGGREGATE_OUTPUT_DISABLE);
    pipeline_.start(config, [this, &to](const std::shared_ptr<ob::FrameSet>& set) {
      for (uint32_t i = 0; i < set->getCount(); ++i) pass_on(*set->getFrameByIndex(i), to);
    });
  }

 private:
  void pass_on(const ob::Frame& frame, LiveFrameBuffer& to) {
    const bool depth = frame.getType() == OB_FRAME_DEPTH;
    if (!depth && frame.getType() != OB_FRAME_COLOR) return;
    const ob::VideoStreamProfile& mode = depth ? *depth_ : *color_;
    RosImage image;
    image.width = static_cast<int>(mode.getWidth()), image.height = static_cast<int>(mode.getHeight());
    image.step = frame.getDataSize() / mode.getHeight();  // without padding
    image.data = {frame.getData(), frame.getDataSize()};
    image.encoding = depth ? "16UC1" : kColorFormats[rank_of(mode.getFormat(), kColorFormats)].encoding;
    const int64_t stamp_ns = clock_.stamp_ns(static_cast<uint32_t>(frame.getTimeStampUs()));
    try {
      if (image.encoding == "jpeg") return to.add_color(stamp_ns, decode_embedded_color(image.data));
      if (!depth) return to.add_color(stamp_ns, color_from(image));
      const double unit_mm = double{frame.as<ob::DepthFrame>()->getValueScale()};
      to.add_depth(stamp_ns, depth_from(image, unit_m_of_sdk(1e-3 * unit_mm)));
    } catch (const InputError& error) {
      log::warn("orbbec: an image is left out: {}", error.what());
    }
  }

  ob::Context context_;
  std::shared_ptr<ob::Device> device_;
  ob::Pipeline pipeline_;
  std::shared_ptr<ob::VideoStreamProfile> color_, depth_;
  DeviceClock clock_{1e3};  ///< counts microseconds
};

}  // namespace

bool orbbec_available() {
  return true;
}

std::unique_ptr<FrameSource> open_orbbec(const KinectOptions& options,
                                         const std::optional<RgbdCamera>& calibration) {
  const auto open = [serial = options.serial,
                     widths = stream_widths(options.width, calibration)](LiveFrameBuffer& to) {
    try {
      ob::Context::setLoggerSeverity(OB_LOG_SEVERITY_OFF);
      const auto device = std::make_shared<OrbbecDevice>(serial, widths);
      device->start(to);
      return LiveDevice{device->camera(), device, device->serial()};
    } catch (const ob::Error& error) {
      throw InputError(fmt::format("orbbec: {}; unplug the camera and plug it in again", error.what()));
    }
  };
  return open_live({"orbbec", open, options.reconnect_s, options.stop}, calibration);
}

}  // namespace kinloop

#else

namespace kinloop {

bool orbbec_available() {
  return false;
}

std::unique_ptr<FrameSource> open_orbbec(const KinectOptions&, const std::optional<RgbdCamera>&) {
  throw UsageError("orbbec: not supported by this build; install OrbbecSDK 2 and rebuild (docs/cameras.md)");
}

}  // namespace kinloop

#endif
