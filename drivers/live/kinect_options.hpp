#pragma once

#include <string>

#include "kinloop/core/options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// What a Kinect 2's frames hold.
enum class Kinect2Frames {
  kRegistered,  ///< depth at each pixel of colour
  kSeparate     ///< for calibration: depth as its camera sees it, and the infrared image
};

/// What decodes the depth of a Kinect 2.
enum class KinectPipeline { kAuto, kCpu, kOpenGl, kOpenCl, kCuda };

constexpr auto option_names(KinectPipeline) {
  using enum KinectPipeline;
  return std::to_array<EnumName<KinectPipeline>>(
      {{kAuto, "auto"}, {kCpu, "cpu"}, {kOpenGl, "opengl"}, {kOpenCl, "opencl"}, {kCuda, "cuda"}});
}

/// How a live camera is opened.
struct KinectOptions {
  std::string serial;
  KinectPipeline pipeline = KinectPipeline::kAuto;
  int width = 960;
  double min_depth_m = 0.5;
  double max_depth_m = 8;
  double reconnect_s = 10;
  // Of the caller, not options:
  StopRequest stop = {};  ///< ends the wait for an unplugged camera
  Kinect2Frames frames = Kinect2Frames::kRegistered;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("serial", self.serial,
          "serial number of the camera, or URI of the OpenNI device; empty: the first one");
    visit("pipeline", self.pipeline, "depth decoder of the Kinect 2");
    visit("width", self.width,
          "width of colour, px: of a Kinect 2 1920, 960 or 512 (512 x 424, as the depth camera sees); of a "
          "RealSense, Orbbec or OAK the nearest available",
          Range{512, 1920});
    visit("min_depth_m", self.min_depth_m, "depth below this is unknown, m", Range{0, 10});
    visit("max_depth_m", self.max_depth_m, "depth above this is unknown, m", Range{0.1, 20});
    visit("reconnect_s", self.reconnect_s, "time to wait for an unplugged camera, s", Range{0, 3600});
  }
};

}  // namespace kinloop
