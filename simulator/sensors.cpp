#include "simulator/sensors.hpp"

#include <array>

#include "kinloop/sensor/camera_presets.hpp"

namespace kinloop::sim {
namespace {

constexpr std::array kKinect2Lens{0.0905, -0.268, 0.0, 0.0, 0.0951};  // k1 k2 p1 p2 k3

RgbdCamera kinect2() {
  RgbdCamera camera;
  camera.color = {960, 540, 540.7, 540.7, 479.5, 269.5, {}};
  camera.depth =
      PinholeCamera{512, 424, 365.5, 365.5, 255.1, 206.8, lens_with(LensModel::kBrownConrady, kKinect2Lens)};
  camera.T_color_depth = {exp_so3({0.003, -0.005, 0.002}), {-0.052, 0.0005, 0.001}};
  camera.sensor = depth_sensor(DepthSensorModel::kKinect2, SensorOrigin::kSource);
  return camera;
}

RgbdCamera realsense() {
  RgbdCamera camera;
  camera.color = {640, 480, 615, 615, 319.5, 239.5, {}};
  camera.depth = PinholeCamera{848, 480, 424, 424, 423.5, 239.5, {}};
  camera.T_color_depth = {exp_so3({-0.002, 0.003, 0.001}), {0.0147, 0.0001, 0.0003}};
  camera.depth_scale = 1000;
  camera.sensor = depth_sensor(DepthSensorModel::kRealsenseD4xx, SensorOrigin::kSource);
  return camera;
}

}  // namespace

RgbdCamera sensor_camera(SimulatedSensor sensor) {
  if (sensor == SimulatedSensor::kKinect2) return kinect2();
  return sensor == SimulatedSensor::kRealsense ? realsense() : camera_preset("freiburg1").value();
}

}  // namespace kinloop::sim
