#include "kinloop/sensor/camera/camera_presets.hpp"

#include <array>

namespace kinloop {
namespace {

RgbdCamera vga_camera(const PinholeCamera& lens, double depth_scale) {
  RgbdCamera camera;
  camera.color = lens;
  camera.color.width = 640;
  camera.color.height = 480;
  camera.depth_scale = depth_scale;
  camera.fps = 30;
  camera.sensor.set_by_source(DepthSensorModel::kKinect1);
  return camera;
}

PinholeCamera pinhole(double fx, double fy, double cx, double cy) {
  PinholeCamera camera;
  camera.fx = fx, camera.fy = fy, camera.cx = cx, camera.cy = cy;
  return camera;
}

PinholeCamera with_distortion(PinholeCamera camera, const std::array<double, 5>& k1_k2_p1_p2_k3) {
  camera.lens = lens_with(LensModel::kBrownConrady, k1_k2_p1_p2_k3);
  return camera;
}

}  // namespace

std::optional<RgbdCamera> camera_preset(std::string_view name) {
  // Sturm et al., the calibration tables of the TUM RGB-D benchmark: fx fy cx cy, k1 k2 p1 p2 k3.
  if (name == "freiburg1") {
    return vga_camera(with_distortion(pinhole(517.306408, 516.469215, 318.643040, 255.313989),
                                      {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}),
                      5000);
  }
  if (name == "freiburg2") {
    return vga_camera(with_distortion(pinhole(520.908620, 521.007327, 325.141442, 249.701764),
                                      {0.231222, -0.784899, -0.003257, -0.000105, 0.917205}),
                      5208);
  }
  if (name == "freiburg3") return vga_camera(pinhole(535.4, 539.2, 320.1, 247.6), 5000);
  // ICL-NUIM (Handa et al. 2014); published with fy = -480 for y up, here y points down.
  if (name == "icl") {
    RgbdCamera rendered = vga_camera(pinhole(481.2, 480.0, 319.5, 239.5), 5000);
    rendered.rolling_shutter_s = 0;
    return rendered;
  }
  return std::nullopt;
}

}  // namespace kinloop
