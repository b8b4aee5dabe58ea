#pragma once
// The simulated sensors and their cameras.

#include "kinloop/core/options.hpp"
#include "kinloop/sensor/rgbd_camera.hpp"

namespace kinloop {

/// A Kinect 1 delivers depth registered to colour; the others have a depth camera of its own pose and lens.
enum class SimulatedSensor { kKinect1, kKinect2, kRealsense };

constexpr auto option_names(SimulatedSensor) {
  return std::to_array<EnumName<SimulatedSensor>>({{SimulatedSensor::kKinect1, "kinect1"},
                                                   {SimulatedSensor::kKinect2, "kinect2"},
                                                   {SimulatedSensor::kRealsense, "realsense"}});
}

namespace sim {

/// Distance of the two infrared cameras of a D435 (data sheet), m.
constexpr double kStereoBaseline_m = 0.05;

/// Returns the cameras at their usual size.
///
/// - kinect1: those of TUM's freiburg1.
/// - kinect2: depth of 512 x 424 with the lens of libfreenect2's default parameters, and 52 mm beside it
///   colour of 960 x 540. The device has 1920 x 1080, which takes four times as long to render and
///   to process.
/// - realsense: a D435, both images rectified. Depth of 848 x 480 at the left infrared camera with 90 degrees
///   of view, and 15 mm beside it colour of 640 x 480.
RgbdCamera sensor_camera(SimulatedSensor sensor);

}  // namespace sim
}  // namespace kinloop
