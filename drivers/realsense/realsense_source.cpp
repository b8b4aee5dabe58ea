#include "drivers/realsense/realsense_source.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_REALSENSE2

#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "drivers/live/device_clock.hpp"
#include "drivers/live/device_selection.hpp"
#include "drivers/live/live_source.hpp"
#include "drivers/realsense/realsense_stream.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "drivers/ros/realsense_bag.hpp"

namespace kinloop {
namespace {

/// A mode of one sensor of the device.
struct RealsenseMode {
  size_t sensor = 0;
  rs2::video_stream_profile profile;
};

rs2::device device_with(const rs2::context& context, const std::string& serial) {
  const rs2::device_list devices = context.query_devices();
  std::vector<std::string> serials;
  for (const rs2::device& device : devices)
    serials.emplace_back(device.get_info(RS2_CAMERA_INFO_SERIAL_NUMBER));
  return devices[static_cast<uint32_t>(
      choose_device("realsense", serials, serial, "librealsense's udev rules"))];
}

RealsenseMode nearest_mode(const std::vector<rs2::sensor>& sensors, rs2_stream stream, rs2_format format,
                           int width) {
  std::optional<RealsenseMode> best;
  const auto distance = [&](const rs2::video_stream_profile& mode) {
    return mode_distance({mode.width(), mode.height(), mode.fps()}, width);
  };
  for (size_t i = 0; i < sensors.size(); ++i) {
    for (const rs2::stream_profile& profile : sensors[i].get_stream_profiles()) {
      if (profile.stream_type() != stream || profile.format() != format) continue;
      const auto mode = profile.as<rs2::video_stream_profile>();
      if (mode && (!best || distance(mode) < distance(best->profile))) best = RealsenseMode{i, mode};
    }
  }
  if (!best) throw InputError("realsense: the camera does not have both colour and depth; use another");
  return *best;
}

/// The SDK names distortion in the same words in its recordings.
PinholeCamera camera_of(const rs2::video_stream_profile& profile) {
  const rs2_intrinsics lens = profile.get_intrinsics();
  RosCameraInfo info;
  info.width = lens.width, info.height = lens.height;
  info.distortion_model = rs2_distortion_to_string(lens.model);
  info.D.assign(std::begin(lens.coeffs), std::end(lens.coeffs));
  info.K = {lens.fx, 0, lens.ppx, 0, lens.fy, lens.ppy, 0, 0, 1};
  return camera_from(info, false);
}

DepthSensorModel realsense_model(const std::string& name) {
  return name.find("L5") == std::string::npos ? DepthSensorModel::kRealsenseD4xx
                                              : DepthSensorModel::kRealsenseL515;
}

/// The colour camera of a D455 or D457 has a global shutter (data sheet), those of the others roll.
bool has_global_shutter(const std::string& name) {
  return name.find("D455") != std::string::npos || name.find("D457") != std::string::npos;
}

/// An open device and its two streams, which may be of one sensor.
class RealsenseDevice {
 public:
  RealsenseDevice(const rs2::device& device, const StreamWidths& widths)
      : device_(device),
        sensors_(device_.query_sensors()),
        color_(nearest_mode(sensors_, RS2_STREAM_COLOR, RS2_FORMAT_BGR8, widths.color)),
        depth_(nearest_mode(sensors_, RS2_STREAM_DEPTH, RS2_FORMAT_Z16, widths.depth)),
        depth_unit_m_(unit_m_of_sdk(double{sensors_[depth_.sensor].get_option(RS2_OPTION_DEPTH_UNITS)})) {}
  ~RealsenseDevice() {
    for (const rs2::sensor& sensor : sensors_) {
      try {
        sensor.stop(), sensor.close();
      } catch (const rs2::error&) {
        continue;  // not started, or unplugged
      }
    }
  }
  RealsenseDevice(const RealsenseDevice&) = delete;
  RealsenseDevice& operator=(const RealsenseDevice&) = delete;

  [[nodiscard]] RgbdCamera camera() const {
    RgbdCamera camera;
    camera.color = camera_of(color_.profile);
    camera.depth = camera_of(depth_.profile);
    const rs2_extrinsics pose = depth_.profile.get_extrinsics_to(color_.profile);  // columns of R first
    const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix3f>(pose.rotation).cast<double>();
    camera.T_color_depth = {Eigen::Quaterniond(R).normalized(),
                            Eigen::Map<const Eigen::Vector3f>(pose.translation).cast<double>()};
    camera.fps = color_.profile.fps();
    const std::string name = device_.get_info(RS2_CAMERA_INFO_NAME);
    camera.sensor.set_by_source(realsense_model(name));
    if (has_global_shutter(name)) camera.rolling_shutter_s = 0;
    return camera;
  }

  [[nodiscard]] std::string serial() const {
    return device_.supports(RS2_CAMERA_INFO_SERIAL_NUMBER) ? device_.get_info(RS2_CAMERA_INFO_SERIAL_NUMBER)
                                                           : "";
  }

  /// Passes the images on, in threads of the library.
  void start(LiveFrameBuffer& to) {
    for (size_t i = 0; i < sensors_.size(); ++i) {
      std::vector<rs2::stream_profile> modes;
      for (const RealsenseMode* mode : {&color_, &depth_}) {
        if (mode->sensor == i) modes.push_back(mode->profile);
      }
      if (modes.empty()) continue;
      sensors_[i].open(modes);
      sensors_[i].start([this, &to](const rs2::frame& frame) { pass_on(frame, to); });
    }
  }

 private:
  void pass_on(const rs2::frame& frame, LiveFrameBuffer& to) {
    const auto image = frame.as<rs2::video_frame>();
    if (!image) return;
    RosImage pixels;
    pixels.width = image.get_width(), pixels.height = image.get_height();
    pixels.step = static_cast<size_t>(image.get_stride_in_bytes());
    pixels.data = {static_cast<const uint8_t*>(image.get_data()),
                   pixels.step * static_cast<size_t>(pixels.height)};
    const bool depth = image.get_profile().stream_type() == RS2_STREAM_DEPTH;
    pixels.encoding = depth ? "16UC1" : "bgr8";
    const auto time_us = static_cast<uint32_t>(std::llround(1e3 * image.get_timestamp()));
    const int64_t stamp_ns = clocks_.at(image.get_frame_timestamp_domain()).stamp_ns(time_us);
    if (depth) return to.add_depth(stamp_ns, depth_from(pixels, depth_unit_m_));
    to.add_color(stamp_ns, color_from(pixels));
  }

  rs2::device device_;
  std::vector<rs2::sensor> sensors_;
  RealsenseMode color_, depth_;
  double depth_unit_m_;
  /// One for each origin of stamps: a device may change from its own counter to the host's time.
  std::array<DeviceClock, 3> clocks_{DeviceClock(1e3), DeviceClock(1e3), DeviceClock(1e3)};
};

LiveDevice open_device(const std::function<rs2::device()>& find, const StreamWidths& widths,
                       LiveFrameBuffer& frames) {
  try {
    const auto device = std::make_shared<RealsenseDevice>(find(), widths);
    device->start(frames);
    return {device->camera(), device, device->serial()};
  } catch (const rs2::error& error) {
    throw InputError(fmt::format("realsense: {}; unplug the camera and plug it in again", error.what()));
  }
}

}  // namespace

std::unique_ptr<FrameSource> open_realsense(const std::function<rs2::device()>& find,
                                            const KinectOptions& options,
                                            const std::optional<RgbdCamera>& calibration) {
  const StreamWidths widths = stream_widths(options.width, calibration);
  const auto open = [=](LiveFrameBuffer& frames) { return open_device(find, widths, frames); };
  return open_live({"realsense", open, options.reconnect_s, options.stop}, calibration);
}

bool realsense_available() {
  return true;
}

std::unique_ptr<FrameSource> open_realsense(const KinectOptions& options,
                                            const std::optional<RgbdCamera>& calibration) {
  const auto find = [context = rs2::context(), serial = options.serial] {
    return device_with(context, serial);
  };
  return open_realsense(find, options, calibration);
}

}  // namespace kinloop

#else

namespace kinloop {

bool realsense_available() {
  return false;
}

std::unique_ptr<FrameSource> open_realsense(const KinectOptions&, const std::optional<RgbdCamera>&) {
  throw UsageError(
      "realsense: not supported by this build; install librealsense2 and rebuild (docs/cameras.md)");
}

}  // namespace kinloop

#endif
