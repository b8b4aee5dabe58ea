#pragma once
// The simulated sensors and their cameras.

#include "kinloop/base/options.hpp"
#include "kinloop/geometry/camera.hpp"

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
/// - kinect2: 512 x 424 depth with the lens of libfreenect2's default parameters, and colour of 960 x 540, 52
/// mm
///   beside it. The device has 1920 x 1080, which takes four times as long to render and to process.
/// - realsense: a D435. Depth of 848 x 480 at the left infrared camera with 90 degrees of view, colour of 640
/// x
///   480 15 mm beside it, both rectified.
RgbdCamera sensor_camera(SimulatedSensor sensor);

}  // namespace sim
}  // namespace kinloop
