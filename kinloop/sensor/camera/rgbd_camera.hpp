#pragma once
// An RGB-D camera as `camera.yaml` describes it.

#include <algorithm>
#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/depth_sensor.hpp"

namespace kinloop {

/// The calibration of an RGB-D camera, the content of `camera.yaml`.
struct RgbdCamera {
  PinholeCamera color;
  double depth_scale = 5000;  ///< units of the depth image per metre
  double depth_shift_m = 0;   ///< added to measured depth
  double fps = 30;            ///< frames per second
  /// Readout time from the first colour row to the last; if unknown, that typical of the sensor is used.
  std::optional<double> rolling_shutter_s;
  double depth_delay_s = 0;  ///< time of the depth measurement minus its stamp
  /// The depth camera, if depth is not registered to colour.
  std::optional<PinholeCamera> depth;
  SE3 T_color_depth;  ///< used only with `depth`
  DepthSensor sensor = {};
  /// The source stores depth in metres, whatever `depth_scale` is. Sources set this; camera.yaml does not.
  bool has_metric_depth = false;
};

/// Returns the readout time of the colour image to begin with, s. An image is read before the next one.
inline double nominal_readout_s(const RgbdCamera& camera) {
  constexpr double kMaxShare = 0.9;  // of the time from one image to the next
  return camera.rolling_shutter_s.value_or(std::min(camera.sensor.typical_readout_s, kMaxShare / camera.fps));
}

}  // namespace kinloop
