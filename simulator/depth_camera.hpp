#pragma once
// In: the pose of a depth camera. Out: its depth image, with the imperfections of its sensor.

#include "simulator/depth_renderer.hpp"
#include "simulator/sensors.hpp"
#include "simulator/stereo_model.hpp"
#include "simulator/time_of_flight_model.hpp"

namespace kinloop::sim {

/// The imperfections of all sensors; those of the chosen one count.
struct DepthCameraNoise {
  TimeOfFlightNoise tof;
  StereoNoise stereo;
};

/// The depth camera of a Kinect 2 or RealSense, beside the colour camera.
class DepthCamera {
 public:
  /// Requires `camera.depth`.
  DepthCamera(const Scene& scene, const RgbdCamera& camera, const DepthCameraNoise& noise, int threads);

  /// Returns measured depth: 32FC1 metres, 0 = unknown. `seed` is that of the frame.
  [[nodiscard]] cv::Mat measure(const SE3& T_room_color, uint64_t seed) const;

 private:
  const Scene* scene_;
  PinholeCamera camera_;
  SE3 T_color_depth_;
  DepthSensorKind kind_;
  DepthCameraNoise noise_;
  int threads_;
  DepthRenderer renderer_;
};

}  // namespace kinloop::sim
